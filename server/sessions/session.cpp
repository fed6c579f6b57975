#include "server/sessions/session.hpp"

#include "common/wire/log_codec.hpp"
#include "core/mapping/snapshot.hpp"
#include "server/log/context.hpp"
#include "server/sessions/checkpoint.hpp"

#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace scanloom::sessions {
namespace {

constexpr double kSliceWork = 5e6;           // in the unit of Reach::work: a few milliseconds
constexpr double kInPlaceWork = 1e6;         // of a group: about a millisecond, during which readers may have to wait
constexpr std::size_t kGroupsDurableMax = 2; // one is being applied, one waits

/// @param created_by  token whose limit it is, if `chunks_max` is below SessionLimits::kMost
Error full(std::size_t chunks, std::size_t chunks_max, const std::string& created_by) {
    const auto whose = chunks_max == SessionLimits::kMost
                           ? std::string("the limit of every session")
                           : fmt::format("the limit `cells` of the token '{}' that created the session", created_by);
    return {Errc::kFull,
            fmt::format("the map has {} chunks of 64 x 64 cells and a scan could take it beyond {}, {}; use "
                        "larger cells or another session",
                        chunks, chunks_max, whose)};
}

Error short_of_memory() {
    return {
        Errc::kOverloaded,
        "the maps in use take all memory that the server may use for maps; try again later, or raise its --map-memory"};
}

} // namespace

Session::Session(SessionInfo info, localization::LocalizedProjection maps, std::optional<Revision> checkpointed,
                 store::ScanLog& log, boost::asio::any_io_executor compute, std::shared_ptr<SessionCounters> counters,
                 const SessionLimits& limits, std::optional<boost::asio::any_io_executor> blocking_executor)
    : info_(std::move(info)), log_(log), counters_(std::move(counters)), limits_(limits),
      blocking_executor_(blocking_executor.value_or(compute)), strand_(std::move(compute)),
      sequencer_(info_, *counters_), maps_(std::move(maps)), appended_(maps_.projection().revision()),
      share_(limits.shared), pages_(maps_.localized().page_count()), checkpoints_(info_.id, checkpointed) {
    share_.take_anyway(static_cast<std::int64_t>(pages_)); // its log is stored, so its maps must be served
    sequencer_.restore(maps_.projection().state());
    for (RobotIndex robot = 0; robot < maps_.projection().robots().size(); ++robot) {
        const auto* poses = maps_.localized().poses().find(robot);
        if (poses == nullptr) continue;
        sequencer_.set_location(robot, poses->location());
        loops_ += poses->estimator().loop_count();
    }
    loop_figures_ = maps_.localized().poses().map().loop_figures();
    moving_scans_ = maps_.localized().moving_scans();
}

std::optional<Error> Session::failure() const {
    const std::lock_guard lock(failure_mutex_);
    return failure_;
}

std::optional<Error> Session::closing() const {
    const std::lock_guard lock(failure_mutex_);
    return closing_;
}

void Session::on_strand(std::function<void(Session&)> work) {
    boost::asio::post(strand_, [self = shared_from_this(), work = std::move(work)]() mutable {
        work(*self);
        self->backlog_size_ = self->waiting_.size();
        self->moving_scans_ = self->maps_.localized().moving_scans();
        self->notify_watchers(); // last, so that acknowledgements go out first
    });
}

void Session::notify_watchers() {
    const auto reported_before = std::exchange(connections_reported_, sequencer_.connection_changes());
    const bool has_news = std::exchange(has_news_, false);
    if (has_news || reported_before != connections_reported_) watchers_.notify();
}

// From a link to the log

void Session::join(JoinRequest who, std::shared_ptr<RobotListener> listener, std::function<void(Result<Joined>)> done) {
    on_strand([joining = PendingJoin{std::move(who), std::move(listener), std::move(done)}](Session& self) mutable {
        if (self.refusing_) return joining.done(*self.refusing_);
        std::vector<PendingEntry> entries;
        if (auto entry = self.sequencer_.join(std::move(joining))) entries.push_back(std::move(*entry));
        self.enqueue(std::move(entries));
    });
}

void Session::leave(std::shared_ptr<RobotListener> listener) {
    on_strand([listener = std::move(listener)](Session& self) { self.sequencer_.leave(listener); });
}

void Session::submit(std::shared_ptr<RobotListener> from, Sensor sensor, std::size_t bytes) {
    on_strand([from = std::move(from), sensor = std::move(sensor), bytes](Session& self) mutable {
        if (!self.refusing_) self.enqueue(self.sequencer_.describe(from, std::move(sensor), bytes));
    });
}

void Session::submit(std::shared_ptr<RobotListener> from, std::vector<Scan> scans, std::size_t bytes) {
    on_strand([from = std::move(from), scans = std::move(scans), bytes](Session& self) mutable {
        if (self.refusing_) {
            self.counters_->scans_dropped += scans.size();
            return;
        }
        self.enqueue(self.sequencer_.take(from, std::move(scans), bytes, self.is_mapped()));
    });
}

bool Session::is_mapped() const { return !mapping::bounds_of(maps_.projection().bounds()).empty(); }

void Session::enqueue(std::vector<PendingEntry> entries) {
    for (auto& entry : entries) waiting_.add(std::move(entry));
    append_next();
}

/// Appends the waiting entries to the log, one group at a time. The next group is appended when the last one is
/// durable, and at most one durable group waits to be applied.
void Session::append_next() {
    while (!appending_ && durable_.size() < kGroupsDurableMax && !waiting_.empty()) {
        const auto taken = static_cast<std::int64_t>(maps_.projection().chunk_count()) + chunks_under_way_;
        const auto left = static_cast<std::int64_t>(limits_.chunks_max) - taken;
        auto group = waiting_.next_group(std::min(left, share_.free()));
        if (!group.entries.empty() && !share_.take(group.chunks)) { // another session took them first
            waiting_.put_back(std::exchange(group, {}));
        }
        if (!group.entries.empty()) {
            append(std::move(group));
        } else if (durable_.empty()) {
            refuse_first(share_.free() < left
                             ? short_of_memory()
                             : full(maps_.projection().chunk_count(), limits_.chunks_max, info_.created_by));
        } else {
            return; // wait until the number of new chunks is known
        }
    }
}

void Session::append(Group group) {
    std::vector<std::string> entries;
    for (const auto& submitted : group.entries) {
        if (submitted.entry) entries.push_back(wire::encode_entry(*submitted.entry));
    }
    if (entries.empty()) return sequencer_.release(group);
    appending_ = true;
    chunks_under_way_ += group.chunks;
    const Revision first = appended_ + 1;
    appended_ += entries.size();
    log_.append(info_.id, first, std::move(entries),
                [self = shared_from_this(), group = std::move(group)](const Result<>& appended) mutable {
                    self->on_strand([group = std::move(group), appended](Session& session) mutable {
                        session.on_appended(std::move(group), appended);
                    });
                });
}

/// Refuses the entries of the robot whose entry is first. Call only while no group is being appended or applied.
void Session::refuse_first(const Error& error) {
    if (error.code == Errc::kOverloaded && limits_.on_short) {
        limits_.on_short(static_cast<std::size_t>(mapping::chunk_count_of(waiting_.front().reach.cells)));
    }
    const RobotIndex robot = waiting_.front().robot;
    waiting_.drop(robot);
    sequencer_.refuse(robot, error, maps_.projection().state());
}

// From the log to the maps, and to the links

void Session::on_appended(Group group, const Result<>& appended) {
    appending_ = false;
    if (!appended && appended.error().code == Errc::kOverloaded) return reset_to_durable(appended.error());
    if (!appended) return stop_writing(appended.error());
    if (broken_) return finish_closing();
    durable_.push_back(std::move(group));
    if (finish_early_) return finish_closing();
    append_next(); // the next group is written while this one is applied
    if (durable_.size() == 1) apply_batch();
}

/// Applies durable entries to the maps for one slice of work, then yields the thread to other sessions.
void Session::apply_batch() {
    if (finish_early_) return finish_closing();
    if (durable_.empty()) return; // dropped in the meantime

    // A small group is applied as a whole, and in place if no reader holds the published maps. Otherwise each chunk
    // that the group changes is copied first.
    const bool is_short = durable_.front().work <= kInPlaceWork && !maps_.projection().has_estimated_poses();
    const bool in_place = is_short && maps_.withdraw();
    auto applied = apply_entries(in_place ? HUGE_VAL : kSliceWork);
    const bool finished = applied && applied_ == durable_.front().entries.size();
    if (in_place && !finished) { // failed, or asked to finish early: publish for the waiting readers
        const auto published = maps_.publish();
        has_news_ = true;
        if (applied) applied = published;
    }
    if (!applied) return stop_writing(applied.error());

    if (finished) {
        const Group group = take_applied_group();
        const auto published = maps_.publish();
        has_news_ = true;
        report_places(group);
        sequencer_.release(group); // its scans are durable and in the maps: they are acknowledged
        if (!published) return stop_writing(published.error());
        count_loops();
        log_localization();
        const bool has_estimated = maps_.projection().has_estimated_poses();
        if (checkpoints_.is_due(maps_.projection().revision(), has_estimated)) begin_checkpoint();
        begin_correction();
        append_next();
    }
    if (!durable_.empty()) return on_strand([](Session& self) { self.apply_batch(); });
    finish_reset();
    finish_closing();
}

/// Applies up to `work` of the first group.
Result<> Session::apply_entries(double work) {
    auto& entries = durable_.front().entries;
    for (; applied_ < entries.size() && work > 0.0 && !finish_early_; ++applied_) {
        PendingEntry& next = entries[applied_];
        if (!next.entry) continue;
        const auto applied = maps_.apply(*next.entry, work);
        if (!applied) return applied.error();
        if (!*applied) return {}; // continues in the next slice
        checkpoints_.count(next);
        if (std::holds_alternative<MapsCorrected>(*next.entry)) {
            if (correction_) ++counters_->maps_corrected;
            drop_correction(); // the maps have taken it
        }
        if (const auto* taken = std::get_if<ScanTaken>(&*next.entry)) {
            count(*taken);
            const auto* poses = maps_.localized().poses().find(taken->robot);
            if (poses != nullptr) sequencer_.set_location(taken->robot, poses->location());
        }
    }
    return {};
}

void Session::count(const ScanTaken& applied) {
    if (!maps_.projection().has_left_out_newest(applied.robot)) {
        ++counters_->scans_applied;
    } else {
        ++(applied.scan.pose ? counters_->scans_jumped : counters_->scans_unplaced);
    }
}

/// Removes the first group, which is applied, and returns the share of the memory that it did not need.
Group Session::take_applied_group() {
    Group group = std::move(durable_.front());
    durable_.pop_front();
    applied_ = 0;
    chunks_under_way_ -= group.chunks;
    const auto grown = maps_.localized().page_count() - std::exchange(pages_, maps_.localized().page_count());
    share_.give_back(group.chunks - static_cast<std::int64_t>(grown)); // which may include more than chunks
    return group;
}

void Session::begin_checkpoint() {
    auto write = [self = shared_from_this(), snapshot = snapshot(), state = maps_.localized().state(),
                  estimation = estimation_to_store(maps_.localized()),
                  since = checkpoints_.begin(maps_.projection().revision())] {
        const auto written = sessions::write_checkpoint(self->log_, self->info_.id, *snapshot, state, since,
                                                        self->finish_early_, estimation);
        if (!written && !self->finish_early_)
            log::warn({.session = self->info_.name}, "session '{}': no checkpoint: {}", self->info_.name,
                      written.error().message);
        self->on_strand([revision = written ? std::optional(state.revision) : since](Session& session) {
            session.checkpoints_.end(revision);
            session.finish_closing();
        });
    };
    boost::asio::post(blocking_executor_, std::move(write)); // not on the strand, which continues to apply entries
}

} // namespace scanloom::sessions
