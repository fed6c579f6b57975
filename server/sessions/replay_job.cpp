#include "server/sessions/replay_job.hpp"

#include "common/wire/log_codec.hpp"
#include "server/sessions/log_readers.hpp"
#include "server/sessions/recovery.hpp"
#include "server/sessions/replay_request.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace scanloom::sessions {
namespace {

constexpr double kReplaySliceWork = 5e6; // between two checks whether to continue
constexpr double kEntryWork = 1e4;       // of reading an entry

/// Reasons to end reading that are not failures.
const Error kTurnIsOver{Errc::kShuttingDown, "other replay jobs have their turn"};
const Error kCancelled{Errc::kShuttingDown, "cancelled"};
const Error kOutdatedMaps{Errc::kShuttingDown, "the entry excludes scans that are in these maps, or brings some back"};

Error no_room() {
    return {Errc::kFull, "this map and those of other replay jobs need more memory than there is for them; use "
                         "larger cells, or try again when the other jobs are done"};
}

SharedExclusions shared(Exclusions exclusions) { return std::make_shared<const Exclusions>(std::move(exclusions)); }

} // namespace

Error session_was_deleted(const SessionInfo& session) {
    return {Errc::kNotFound,
            fmt::format("session '{}' was deleted while its maps were computed again; see the list of sessions",
                        session.name)};
}

// Requests

ReplayJob::Progress ReplayJob::progress() const {
    const std::lock_guard lock(mutex_);
    const bool follows = !request_.end.revision && !is_complete_;
    return {state_, applied_, target_, maps_ ? std::optional(maps_->revision) : std::nullopt, follows, error_};
}

std::shared_ptr<const mapping::Snapshot> ReplayJob::maps() const {
    const std::lock_guard lock(mutex_);
    return maps_;
}

/// Pre: mutex_ is held.
bool ReplayJob::is_ready(Revision revision) const noexcept {
    return maps_ && version_ == wanted_poses_.version() && (maps_->revision >= revision || state_ == State::kDone);
}

std::shared_ptr<const mapping::Snapshot> ReplayJob::maps_with(Revision revision) const {
    const std::lock_guard lock(mutex_);
    return is_ready(revision) ? maps_ : nullptr;
}

void ReplayJob::notify(Revision revision, std::function<void()> on_ready) {
    const std::lock_guard lock(mutex_);
    waiting_.push_back({revision, std::move(on_ready)});
    call_waiting();
}

/// Pre: mutex_ is held.
void ReplayJob::call_waiting() {
    std::erase_if(waiting_, [&](const Waiting& one) {
        const bool is_over = has_ended(state_) || is_ready(one.revision);
        if (is_over) one.on_ready();
        return is_over;
    });
}

bool ReplayJob::join(Revision target, const mapping::ScanPoses& poses) {
    const std::lock_guard lock(mutex_);
    if (poses.version() > wanted_poses_.version() || target > target_) wanted_poses_ = poses;
    const bool is_newest = version_ == wanted_poses_.version();
    if (state_ == State::kDone) return is_newest && (is_complete_ || target <= target_);
    if (has_ended(state_) || cancelled_) return false;
    target_ = std::max(target_, target);
    return true;
}

bool ReplayJob::resume(Revision target, limits::MemoryBudget& budget) {
    const std::lock_guard lock(mutex_);
    const auto chunks = static_cast<std::int64_t>(maps_->chunk_count);
    if (!budget.take(chunks)) return false;
    claimed_ = chunks;
    target_ = target;
    state_ = State::kWaiting;
    return true;
}

// Starting from another job

mapping::ScanPoses::Version ReplayJob::wanted_version() const {
    const std::lock_guard lock(mutex_);
    return wanted_poses_.version();
}

bool ReplayJob::is_same_map(const ReplayJob& other) const {
    return session_.id == other.session_.id && request_.config == other.request_.config &&
           wanted_version() == other.wanted_version();
}

std::optional<Revision> ReplayJob::base_for(const ReplayJob& other, Revision target) const {
    if (!is_same_map(other)) return std::nullopt;
    const auto wanted = other.wanted_version();
    const std::lock_guard lock(mutex_);
    return revision_before(other, wanted, target);
}

/// @param wanted  of the poses that the other job wants
/// Pre: mutex_ is held.
std::optional<Revision> ReplayJob::revision_before(const ReplayJob& other, const mapping::ScanPoses::Version& wanted,
                                                   Revision target) const {
    const auto& end = other.request_.end;
    const bool stands_still = state_ == State::kDone || (state_ == State::kWaiting && !cancelled_);
    if (!stands_still || !projection_ || projection_->revision() > target) return std::nullopt;
    if (poses_.version() != wanted) return std::nullopt;
    const Revision known = projection_->exclusions()->revision();
    const bool is_same = known == other.session_.exclusions->as_of(target).revision();
    // A job with an end stamp may end before it reads exclusions that this one does not know: they must be equal.
    if (end.stamp ? !is_same : known > target) return std::nullopt;
    if (end.stamp && newest_stamp_ && *newest_stamp_ > *end.stamp) return std::nullopt;
    return projection_->revision();
}

bool ReplayJob::leads_to(const ReplayJob& other, Revision target) const {
    const auto& end = request_.end.revision;
    if (!is_same_map(other) || !end || *end > target || other.request_.end.stamp) return false;
    const std::lock_guard lock(mutex_);
    return !has_ended(state_) && !cancelled_;
}

bool ReplayJob::begin_from(ReplayJob& base) {
    const Revision target = progress().target;
    const auto wanted = wanted_version();
    std::optional<mapping::Projection> branch;
    std::optional<double> newest_stamp;
    mapping::ScanPoses poses;
    {
        const std::lock_guard lock(base.mutex_);
        if (!base.revision_before(*this, wanted, target)) return false;
        branch.emplace(base.projection_->branch());
        newest_stamp = base.newest_stamp_;
        poses = base.poses_;
    }
    const std::lock_guard lock(mutex_);
    projection_.emplace(std::move(*branch));
    newest_stamp_ = newest_stamp;
    poses_ = poses;
    applied_ = projection_->revision();
    return true;
}

void ReplayJob::cancel(Error reason) {
    const std::lock_guard lock(mutex_);
    if (has_ended(state_) || cancelled_) return;
    cancelled_ = true; // checked by the thread in run()
    error_ = std::move(reason);
    if (state_ == State::kWaiting) state_ = State::kCancelled;
    call_waiting();
}

// Replay

bool ReplayJob::run(store::ScanLog& log, limits::MemoryBudget& budget, double turn_work) {
    const auto target = begin();
    if (!target) {
        give_up(kCancelled, budget);
        return false;
    }
    turn_left_ = turn_work;
    try {
        if (!projection_)
            projection_.emplace(request_.config, shared(session_.exclusions->as_of(*target)), poses_.corrected());
        auto is_complete = apply_up_to(*target, log, budget);
        if (!is_complete && is_complete.error() == kOutdatedMaps) {
            const auto begun = begin_again(*target, log, budget);
            is_complete = begun ? apply_up_to(*target, log, budget) : begun.error();
        }
        if (!is_complete && is_complete.error() == kTurnIsOver) return wait_for_another_turn(*target);
        if (is_complete) return publish(*target, *is_complete, budget);
        give_up(is_complete.error(), budget);
    } catch (const std::bad_alloc&) {
        give_up(no_room(), budget);
    }
    return false;
}

/// Starts a turn. @return the target of the round; nullopt if the job was cancelled
std::optional<Revision> ReplayJob::begin() {
    const std::lock_guard lock(mutex_);
    if (state_ != State::kWaiting) return std::nullopt;
    state_ = State::kRunning;
    if (poses_.version() != wanted_poses_.version()) { // the scans in the projection have moved
        projection_.reset();
        newest_stamp_.reset();
        applied_ = 0;
        round_.reset();
    }
    poses_ = wanted_poses_;
    return std::exchange(round_, std::nullopt).value_or(target_);
}

/// Ends a turn. The round continues after the turns of the other waiting jobs.
bool ReplayJob::wait_for_another_turn(Revision target) {
    const std::lock_guard lock(mutex_);
    state_ = State::kWaiting;
    round_ = target;
    return true;
}

/// Applies entries up to `target`. @return whether the job has reached its end
Result<bool> ReplayJob::apply_up_to(Revision target, store::ScanLog& log, limits::MemoryBudget& budget) {
    bool is_complete = request_.end.revision.has_value();
    if (auto claimed = claim(budget); !claimed) return claimed.error(); // of its initial state
    const auto read = log.read(session_.id, projection_->revision(),
                               [&](Revision revision, std::string_view bytes) -> store::Visited {
                                   if (revision > target) return store::Visit::kStop;
                                   if (turn_left_ <= 0.0) return kTurnIsOver;
                                   auto entry = wire::decode_entry(bytes);
                                   if (!entry) return damaged_entry(revision, entry.error());
                                   poses_.place(*entry);
                                   if (is_beyond_end(revision, *entry)) {
                                       is_complete = true;
                                       return store::Visit::kStop;
                                   }
                                   if (projection_->is_outdated_by(*entry)) return kOutdatedMaps;
                                   if (auto ok = check_replayable(*projection_, *entry); !ok) return ok;
                                   return apply(*entry, budget);
                               });
    if (!read && read.error().code == Errc::kNotFound) return session_was_deleted(session_);
    if (!read) return read.error();
    return is_complete;
}

/// Returns whether the entry is a scan, not excluded, with a stamp after the end of the job.
bool ReplayJob::is_beyond_end(Revision revision, const LogEntry& entry) const {
    const auto* taken = std::get_if<ScanTaken>(&entry);
    return taken != nullptr && request_.end.stamp && taken->scan.stamp > *request_.end.stamp &&
           !projection_->exclusions()->cover(revision, scan_pose_of(*taken));
}

/// Restarts with all exclusions up to `target`. Releases the earlier maps first, because both may not fit into memory.
Result<> ReplayJob::begin_again(Revision target, store::ScanLog& log, limits::MemoryBudget& budget) {
    const auto exclusions = read_exclusions(log, session_.id, [&](Revision revision, const std::optional<ScanPose>&) {
        return revision <= target && !cancelled_;
    });
    if (!exclusions) return exclusions.error();
    if (cancelled_) return kCancelled;
    forget_maps();
    projection_.emplace(request_.config, shared(*exclusions), poses_.corrected());
    newest_stamp_.reset();
    applied_ = 0;
    return claim(budget);
}

Result<> ReplayJob::apply(const LogEntry& entry, limits::MemoryBudget& budget) {
    for (bool in = false; !in;) {
        if (cancelled_) return kCancelled;
        double work = kReplaySliceWork;
        const auto applied = projection_->apply(entry, work);
        if (!applied) return applied.error();
        in = *applied;
        turn_left_ -= std::max(kReplaySliceWork - work, kEntryWork);
        if (auto claimed = claim(budget); !claimed) return claimed;
    }
    applied_ = projection_->revision();
    const auto* taken = std::get_if<ScanTaken>(&entry);
    if (taken != nullptr && !projection_->exclusions()->cover(applied_, scan_pose_of(*taken))) {
        newest_stamp_ = std::max(newest_stamp_.value_or(taken->scan.stamp), taken->scan.stamp);
    }
    return {};
}

/// Takes the chunks of the current state from the budget.
Result<> ReplayJob::claim(limits::MemoryBudget& budget) {
    const std::size_t chunks = projection_->chunk_count();
    const std::size_t copied = maps_ ? projection_->copied_count() : 0; // maps_ is set by this thread alone
    if (claim(chunks + copied, budget)) return {};
    forget_maps(); // then copied chunks need no second page
    return claim(chunks, budget) ? Result<>{} : no_room();
}

bool ReplayJob::claim(std::size_t chunks, limits::MemoryBudget& budget) {
    const std::int64_t more = static_cast<std::int64_t>(chunks) - claimed_;
    if (more > 0 && !budget.take(more)) return false;
    if (more < 0) budget.give_back(-more);
    claimed_ += more;
    return true;
}

void ReplayJob::forget_maps() {
    std::shared_ptr<const mapping::Snapshot> maps;
    const std::lock_guard lock(mutex_);
    maps_.swap(maps);
}

/// Publishes the maps of a round. @return whether the target was raised during the round
bool ReplayJob::publish(Revision target, bool is_complete, limits::MemoryBudget& budget) {
    auto maps = std::make_shared<const mapping::Snapshot>(projection_->snapshot());
    const std::lock_guard lock(mutex_);
    maps_.swap(maps);
    version_ = poses_.version();
    is_complete_ = is_complete;
    if (is_complete) target_ = maps_->revision;
    if (cancelled_ || (target_ <= target && version_ == wanted_poses_.version())) {
        end(State::kDone, budget);
        return false;
    }
    state_ = State::kWaiting;
    call_waiting();
    return true;
}

void ReplayJob::give_up(const Error& error, limits::MemoryBudget& budget) {
    projection_.reset();
    const std::lock_guard lock(mutex_);
    if (!cancelled_) error_ = error;
    end(State::kFailed, budget);
}

/// Ends the job; it may be resumed after this. Pre: mutex_ is held.
void ReplayJob::end(State state, limits::MemoryBudget& budget) {
    budget.give_back(std::exchange(claimed_, 0));
    state_ = cancelled_ ? State::kCancelled : state;
    call_waiting();
}

} // namespace scanloom::sessions
