#include "server/sessions/replay_jobs.hpp"

#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <new>
#include <utility>

namespace scanloom::sessions {
namespace {

std::size_t chunks_of(const ReplayJob& job) {
    const auto maps = job.maps();
    return maps ? maps->chunk_count : 0;
}

Error was_removed(const ReplayJob& job) {
    return {Errc::kNotFound,
            fmt::format("replay job {} was deleted before these maps were done; start it again", job.id())};
}

} // namespace

ReplayJobs::ReplayJobs(store::ScanLog& log, boost::asio::any_io_executor executor, const ReplayLimits& limits)
    : log_(log), executor_(std::move(executor)), limits_(limits), budget_(limits.chunks_max) {}

Result<std::shared_ptr<ReplayJob>> ReplayJobs::start(const SessionInfo& session, const ReplayRequest& request,
                                                     Revision newest, const mapping::ScanPoses& poses,
                                                     Listing listing) {
    const std::lock_guard lock(mutex_);
    auto job = started(session, request, target_of(request, newest), poses);
    if (job && listing == Listing::kListed) (*job)->set_listed(++listed_);
    evict();
    return job;
}

/// Pre: mutex_ is held.
Result<std::shared_ptr<ReplayJob>> ReplayJobs::started(const SessionInfo& session, const ReplayRequest& request,
                                                       Revision target, const mapping::ScanPoses& poses) {
    auto job = touch(session.id, replay_id_of(session, request));
    if (job && job->join(target, poses)) return job;
    if (auto room = check_room(); !room) return room.error();
    if (job && job->progress().state == ReplayJob::State::kDone) {
        if (!job->resume(target, budget_)) {
            return Error{Errc::kOverloaded,
                         "the running replay jobs need all memory that there is for their maps; try again soon"};
        }
    } else {
        const std::uint64_t listed = job ? job->listed() : 0;
        if (job) jobs_.pop_front();
        job = std::make_shared<ReplayJob>(session, request, target, poses);
        job->set_listed(listed);
        jobs_.push_front(job);
    }
    launch(job);
    return job;
}

std::size_t ReplayJobs::under_way() const {
    const std::lock_guard lock(mutex_);
    return count_under_way();
}

/// Pre: mutex_ is held.
std::size_t ReplayJobs::count_under_way() const {
    return static_cast<std::size_t>(
        std::ranges::count_if(jobs_, [](const auto& job) { return !has_ended(job->progress().state); }));
}

/// Pre: mutex_ is held.
Result<> ReplayJobs::check_room() const {
    if (stopped_) return shutting_down();
    if (count_under_way() < limits_.waiting_max) return {};
    return Error{Errc::kOverloaded, "too many replay jobs are running at this moment; try again soon"};
}

/// Starts a job. It begins here and not on the executor, so that the state of an earlier job is visible to the next
/// one. Pre: mutex_ is held.
void ReplayJobs::launch(const std::shared_ptr<ReplayJob>& job) {
    if (job->has_begun() || begin(job)) post(job);
}

void ReplayJobs::post(std::shared_ptr<ReplayJob> job) {
    boost::asio::post(executor_, [this, job = std::move(job)] { run(job); });
}

void ReplayJobs::run(const std::shared_ptr<ReplayJob>& job) {
    if (job->run(log_, budget_)) return post(job); // after the other waiting jobs
    const std::lock_guard lock(mutex_);
    launch_successors(*job);
    evict();
}

/// Starts the job from the best other job. Pre: mutex_ is held. @return false if it waits for the end of another job
bool ReplayJobs::begin(const std::shared_ptr<ReplayJob>& job) {
    try {
        while (const auto start = furthest_before(*job)) {
            if (start->is_running) {
                successors_.push_back({start->job, job});
                return false;
            }
            if (job->begin_from(*start->job)) return true;
        }
    } catch (const std::bad_alloc&) { // start from the beginning, which reports missing memory itself
    }
    return true;
}

/// Pre: mutex_ is held.
std::optional<ReplayJobs::Start> ReplayJobs::furthest_before(const ReplayJob& job) const {
    const auto wanted = job.progress();
    std::optional<Start> furthest;
    if (has_ended(wanted.state)) return furthest; // cancelled
    for (const auto& other : jobs_) {
        if (other.get() == &job) continue;
        const bool is_running = other->leads_to(job, wanted.target);
        const auto at = is_running ? std::optional(other->progress().applied) : other->base_for(job, wanted.target);
        if (!at || (furthest && std::pair(*at, is_running) <= std::pair(furthest->at, furthest->is_running))) {
            continue;
        }
        furthest = Start{other, *at, is_running};
    }
    return furthest;
}

/// Pre: mutex_ is held.
void ReplayJobs::launch_successors(const ReplayJob& ended) {
    const auto waited = std::stable_partition(successors_.begin(), successors_.end(), [&](const Successor& successor) {
        return successor.ahead.get() != &ended;
    });
    const std::vector<Successor> next(waited, successors_.end());
    successors_.erase(waited, successors_.end());
    for (const Successor& successor : next) launch(successor.job); // in the order in which they started to wait
}

std::shared_ptr<ReplayJob> ReplayJobs::find(store::SessionId session, std::string_view id) {
    const std::lock_guard lock(mutex_);
    return touch(session, id);
}

/// Returns the job, moved to the front of the list; null if it does not exist. Pre: mutex_ is held.
std::shared_ptr<ReplayJob> ReplayJobs::touch(store::SessionId session, std::string_view id) {
    evict();
    const auto found =
        std::ranges::find_if(jobs_, [&](const auto& job) { return job->session().id == session && job->id() == id; });
    if (found == jobs_.end()) return nullptr;
    jobs_.splice(jobs_.begin(), jobs_, found);
    return jobs_.front();
}

std::vector<std::shared_ptr<ReplayJob>> ReplayJobs::list(store::SessionId session) const {
    const std::lock_guard lock(mutex_);
    std::vector<std::shared_ptr<ReplayJob>> of_session;
    std::ranges::copy_if(jobs_, std::back_inserter(of_session),
                         [&](const auto& job) { return job->session().id == session && job->listed() > 0; });
    std::ranges::sort(of_session, std::greater{}, &ReplayJob::listed);
    return of_session;
}

bool ReplayJobs::remove(store::SessionId session, std::string_view id) {
    const std::lock_guard lock(mutex_);
    return std::erase_if(jobs_, [&](const auto& job) {
               if (job->session().id != session || job->id() != id) return false;
               job->cancel(was_removed(*job));
               return true;
           }) > 0;
}

void ReplayJobs::remove_all(store::SessionId session) {
    const std::lock_guard lock(mutex_);
    std::erase_if(jobs_, [&](const auto& job) {
        if (job->session().id != session) return false;
        job->cancel(session_was_deleted(job->session()));
        return true;
    });
}

std::int64_t ReplayJobs::chunks() const {
    const std::lock_guard lock(mutex_);
    std::size_t kept = 0;
    for (const auto& job : jobs_) {
        if (has_ended(job->progress().state)) kept += chunks_of(*job);
    }
    return budget_.used() + static_cast<std::int64_t>(kept);
}

void ReplayJobs::stop() {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    for (const auto& job : jobs_) job->cancel(shutting_down());
}

/// Pre: mutex_ is held.
void ReplayJobs::evict() {
    std::size_t kept = 0;
    std::size_t chunks = 0;
    for (const bool listed : {true, false}) {
        std::erase_if(jobs_, [&](const auto& job) {
            if ((job->listed() > 0) != listed || !has_ended(job->progress().state)) return false;
            ++kept;
            chunks += chunks_of(*job);
            return kept > limits_.kept_max || chunks > limits_.chunks_kept_max;
        });
    }
}

} // namespace scanloom::sessions
