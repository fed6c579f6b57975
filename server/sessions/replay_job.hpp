#pragma once

#include "common/error/error.hpp"
#include "common/limits/memory_budget.hpp"
#include "core/mapping/projection.hpp"
#include "server/sessions/replay_request.hpp"
#include "server/sessions/session_info.hpp"
#include "server/store/scan_log.hpp"

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::sessions {

/// Replay job: computes the maps of a session again from its log, with other settings or up to an earlier moment. The
/// result equals the maps of a session that was created with these settings and received the same log.
///
/// A job has a target, a revision of the log. A job that follows its session gets a later target with each new request
/// and continues from its current state, so no entry is applied twice. It works in rounds. Each round ends at the
/// target at the start of the round; until then, the maps of the last round are served. So a request is served when its
/// entry is applied, even if later requests raise the target.
///
/// A job that has not begun can start from a copy of the state of another job with the same session and settings. It is
/// independent of the other job afterwards. Its maps are bit for bit the same as without that start.
///
/// Scans that robots sent without poses are at the poses in the session's maps at the newest request. If they were
/// corrected since the request before, the job begins again.
/// Memory: a round takes its chunks from the budget, also the chunks of its earlier maps that it has copied to change
/// them. If both do not fit, it releases the earlier maps. Chunks shared with the job that it started from count for
/// both jobs, because either may outlive the other.
/// Threads: any thread, except as stated at run() and resume().
class ReplayJob {
public:
    static constexpr double kTurnWork = 1e8; ///< work of a turn, in the unit of Reach::work: about one second

    enum class State : std::uint8_t { kWaiting, kRunning, kDone, kFailed, kCancelled };

    struct Progress {
        State state = State::kWaiting;
        Revision applied = 0;             ///< applied entries
        Revision target = 0;              ///< entries to apply
        std::optional<Revision> revision; ///< of the finished maps, if there are any
        bool follows = false;             ///< whether the target can be raised
        std::optional<Error> error;       ///< why it failed or was cancelled
    };

    /// Creates a job that has not begun.
    /// @param target  revision up to which entries are applied
    /// @param poses   of the session's maps
    ReplayJob(SessionInfo session, const ReplayRequest& request, Revision target, mapping::ScanPoses poses = {})
        : id_(replay_id_of(session, request)), session_(std::move(session)), request_(request), target_(target),
          wanted_poses_(std::move(poses)) {}

    [[nodiscard]] const std::string& id() const noexcept { return id_; }
    [[nodiscard]] const SessionInfo& session() const noexcept { return session_; }
    [[nodiscard]] const ReplayRequest& request() const noexcept { return request_; }

    /// Sets the job's place in the list of the session's jobs.
    /// @param number  the newest job has the greatest; 0: not listed. Jobs that a GET request starts are not listed,
    ///                because GET must not change what other clients see.
    void set_listed(std::uint64_t number) noexcept { listed_ = number; }
    [[nodiscard]] std::uint64_t listed() const noexcept { return listed_; }

    [[nodiscard]] Progress progress() const;

    /// Returns the newest finished maps; null if there are none.
    [[nodiscard]] std::shared_ptr<const mapping::Snapshot> maps() const;

    /// Returns the finished maps if they contain the entry `revision`, or if the job has ended before it.
    /// @param revision  at most a target that was requested before
    /// @return null if there are no such maps; progress() has the reason
    [[nodiscard]] std::shared_ptr<const mapping::Snapshot> maps_with(Revision revision) const;

    /// Calls `on_ready` once: when maps_with(`revision`) returns maps or the job has ended. Before it returns, if that
    /// is so already.
    /// @param on_ready  called on any thread; does not block and does not use this object
    void notify(Revision revision, std::function<void()> on_ready);

    /// Requests maps up to `target`.
    /// @param poses  of the session's maps at that revision or a later one
    /// @return whether they exist or a job that is not finished will compute them; if false, call resume() for a done
    ///         job, otherwise start a new one
    [[nodiscard]] bool join(Revision target, const mapping::ScanPoses& poses = {});

    /// Prepares a done job for another run() up to `target`. Call only in state kDone, after join() returned false, and
    /// from one thread at a time.
    /// @return false if the budget has no room now
    [[nodiscard]] bool resume(Revision target, limits::MemoryBudget& budget);

    /// Returns the revision at which `other`, with the target `target`, could start from this job.
    /// @return nullopt if the session or the settings differ, or if this job is past the end of the other, has failed,
    ///         has not begun or is running
    [[nodiscard]] std::optional<Revision> base_for(const ReplayJob& other, Revision target) const;

    /// Returns whether `other` will be able to start from this job when this job ends. progress() shows whether waiting
    /// for it is worthwhile. Two jobs never wait for each other, because the end of `other` is later.
    [[nodiscard]] bool leads_to(const ReplayJob& other, Revision target) const;

    /// Starts this job from a copy of the state of `base`. Call only before the first run(), and from one thread at a
    /// time.
    /// @return false if `base` is not a possible start, or no longer; see base_for()
    [[nodiscard]] bool begin_from(ReplayJob& base);

    /// Ends the job soon with the error `reason`, unless it has ended already.
    void cancel(Error reason);

    /// Applies entries for one turn: up to the target of the round, or `turn_work`.
    ///
    /// Sets a low priority for the calling thread. The job ends early and loses its state if it is cancelled, if the
    /// budget is used up, or if the log contains entries that cannot be applied with these settings.
    /// @param turn_work  in the unit of Reach::work
    /// @return whether the job must be run again
    /// Threads: one at a time.
    [[nodiscard]] bool run(store::ScanLog& log, limits::MemoryBudget& budget, double turn_work = kTurnWork);

    /// Returns whether the job has a state to continue from.
    /// Threads: only the thread that may call run().
    [[nodiscard]] bool has_begun() const noexcept { return projection_.has_value(); }

private:
    [[nodiscard]] bool is_ready(Revision revision) const noexcept;
    void call_waiting();
    [[nodiscard]] mapping::ScanPoses::Version wanted_version() const;
    [[nodiscard]] bool is_same_map(const ReplayJob& other) const;
    [[nodiscard]] std::optional<Revision>
    revision_before(const ReplayJob& other, const mapping::ScanPoses::Version& wanted, Revision target) const;
    [[nodiscard]] std::optional<Revision> begin();
    [[nodiscard]] Result<bool> apply_up_to(Revision target, store::ScanLog& log, limits::MemoryBudget& budget);
    [[nodiscard]] bool is_beyond_end(Revision revision, const LogEntry& entry) const;
    [[nodiscard]] Result<> begin_again(Revision target, store::ScanLog& log, limits::MemoryBudget& budget);
    [[nodiscard]] bool wait_for_another_turn(Revision target);
    [[nodiscard]] Result<> apply(const LogEntry& entry, limits::MemoryBudget& budget);
    [[nodiscard]] Result<> claim(limits::MemoryBudget& budget);
    [[nodiscard]] bool claim(std::size_t chunks, limits::MemoryBudget& budget);
    void forget_maps();
    [[nodiscard]] bool publish(Revision target, bool is_complete, limits::MemoryBudget& budget);
    void give_up(const Error& error, limits::MemoryBudget& budget);
    void end(State state, limits::MemoryBudget& budget);

    const std::string id_;
    const SessionInfo session_;
    const ReplayRequest request_;

    std::atomic<Revision> applied_ = 0;
    std::atomic<bool> cancelled_ = false;
    std::atomic<std::uint64_t> listed_ = 0;

    // Used by the thread in run() or resume() only; between those calls, guarded by the mutex.
    std::optional<mapping::Projection> projection_; // kept to continue, and as a start for other jobs
    std::optional<double> newest_stamp_;            // seconds; of the scans in the projection
    mapping::ScanPoses poses_;                      // of the scans in the projection
    std::int64_t claimed_ = 0;                      // chunks taken from the budget; 0 after the job has ended
    double turn_left_ = 0.0;                        // in the unit of Reach::work

    mutable std::mutex mutex_; // guards the members below
    State state_ = State::kWaiting;
    Revision target_;
    mapping::ScanPoses wanted_poses_;
    std::optional<Revision> round_; // target of a round that is not finished
    bool is_complete_ = false;      // the job has reached its end; no entry can follow
    std::shared_ptr<const mapping::Snapshot> maps_;
    mapping::ScanPoses::Version version_; // of the poses in these maps
    std::optional<Error> error_;

    struct Waiting {
        Revision revision;
        std::function<void()> on_ready;
    };
    std::vector<Waiting> waiting_;
};

/// Returns whether the job does nothing more until it is requested again.
[[nodiscard]] constexpr bool has_ended(ReplayJob::State state) noexcept {
    return state != ReplayJob::State::kWaiting && state != ReplayJob::State::kRunning;
}

/// Returns the error (kNotFound) for clients that wait for a replay job of a session that was deleted.
[[nodiscard]] Error session_was_deleted(const SessionInfo& session);

} // namespace scanloom::sessions
