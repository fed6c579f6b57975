#pragma once

#include "common/error/error.hpp"
#include "server/sessions/replay_job.hpp"
#include "server/sessions/session.hpp"
#include "server/store/scan_log.hpp"

#include <boost/asio/any_io_executor.hpp>

#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string_view>
#include <vector>

namespace scanloom::sessions {

struct ReplayLimits {
    std::size_t waiting_max = 16;          ///< jobs that have not ended
    std::size_t kept_max = 32;             ///< ended jobs
    std::size_t chunks_max = 131'072;      ///< of all jobs that have not ended: 2.5 GiB
    std::size_t chunks_kept_max = 131'072; ///< of all ended jobs: 2.5 GiB, the maximum of a single job
};

/// The replay jobs of all sessions: waiting, running, and the most recently used ended jobs.
///
/// A new job starts from the job with the same map whose state is the latest before its own end. If that job is still
/// running, the new one waits for its end. So stepping forward through the history of a session applies each entry
/// once, and stepping back starts from the latest kept job before that moment.
///
/// Queue: "replay jobs", at most waiting_max jobs that have not ended; another one is refused with kOverloaded. Ended
/// jobs are evicted when their place is needed, the least recently used first, and jobs that are not listed before
/// others.
/// Memory: each job counts with all of its chunks, even if it shares unchanged chunks with the job that it started
/// from. So the bounds hold in whatever order jobs are evicted.
/// Threads: any thread; nothing here blocks.
class ReplayJobs {
public:
    /// @param log  must outlive the jobs on the executor, as must this object
    /// @param executor  runs the jobs, as many at a time as it has threads, one turn after another
    ReplayJobs(store::ScanLog& log, boost::asio::any_io_executor executor, const ReplayLimits& limits = {});

    enum class Listing { kListed, kUnlisted };

    /// Starts a job, or continues the existing job of this request up to `newest`. A job that failed or was cancelled
    /// is started again from the beginning.
    ///
    /// @param newest  current revision of the session
    /// @param poses   of the session's maps at that revision
    /// @param listing  kListed adds the job to list(); a listed job stays listed
    /// Errors: kOverloaded if too many jobs have not ended or the memory for them is used up; kShuttingDown.
    [[nodiscard]] Result<std::shared_ptr<ReplayJob>> start(const SessionInfo& session, const ReplayRequest& request,
                                                           Revision newest, const mapping::ScanPoses& poses = {},
                                                           Listing listing = Listing::kListed);

    /// Returns the job; null if it does not exist or was evicted.
    [[nodiscard]] std::shared_ptr<ReplayJob> find(store::SessionId session, std::string_view id);

    /// Returns the listed jobs of a session, the last started first.
    [[nodiscard]] std::vector<std::shared_ptr<ReplayJob>> list(store::SessionId session) const;

    /// Cancels and removes a job. @return whether it existed
    bool remove(store::SessionId session, std::string_view id);

    /// Cancels and removes all jobs of a deleted session.
    void remove_all(store::SessionId session);

    /// Returns the number of jobs that have not ended.
    [[nodiscard]] std::size_t under_way() const;

    /// Returns the number of chunks of all jobs. Shared chunks count more than once.
    [[nodiscard]] std::int64_t chunks() const;

    /// Cancels all jobs. No job can be started afterwards.
    void stop();

private:
    /// A job that another job can start from.
    struct Start {
        std::shared_ptr<ReplayJob> job;
        Revision at = 0;
        bool is_running = false; // it is still running, and ends where the other job can start
    };

    [[nodiscard]] Result<std::shared_ptr<ReplayJob>> started(const SessionInfo& session, const ReplayRequest& request,
                                                             Revision target, const mapping::ScanPoses& poses);
    [[nodiscard]] std::shared_ptr<ReplayJob> touch(store::SessionId session, std::string_view id);
    [[nodiscard]] std::size_t count_under_way() const;
    [[nodiscard]] Result<> check_room() const;
    void launch(const std::shared_ptr<ReplayJob>& job);
    void post(std::shared_ptr<ReplayJob> job);
    void run(const std::shared_ptr<ReplayJob>& job);
    [[nodiscard]] bool begin(const std::shared_ptr<ReplayJob>& job);
    [[nodiscard]] std::optional<Start> furthest_before(const ReplayJob& job) const;
    void launch_successors(const ReplayJob& ended);
    void evict();

    store::ScanLog& log_;
    boost::asio::any_io_executor executor_;
    const ReplayLimits limits_;
    limits::MemoryBudget budget_;

    mutable std::mutex mutex_;
    bool stopped_ = false;
    std::uint64_t listed_ = 0;                   // number of the last listed job
    std::list<std::shared_ptr<ReplayJob>> jobs_; // most recently used first

    struct Successor {
        std::shared_ptr<ReplayJob> ahead;
        std::shared_ptr<ReplayJob> job; // begins when the one ahead has ended, successfully or not
    };
    std::vector<Successor> successors_;
};

} // namespace scanloom::sessions
