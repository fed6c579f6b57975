#pragma once

#include "common/error/error.hpp"
#include "common/limits/memory_budget.hpp"
#include "common/scan/log_entry.hpp"
#include "core/mapping/projection.hpp"
#include "server/sessions/backlog.hpp"
#include "server/sessions/checkpoint_schedule.hpp"
#include "server/sessions/listeners.hpp"
#include "server/sessions/robot_sequencer.hpp"
#include "server/sessions/session_info.hpp"
#include "server/sessions/session_maps.hpp"
#include "server/store/scan_log.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/strand.hpp>

#include <atomic>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace scanloom::sessions {

/// One session: the only writer of its log and of the maps derived from it.
///
/// The path of a scan: submit() -> (strand) RobotSequencer checks order and duplicates -> Backlog -> a group is
/// appended to the ScanLog -> the group is durable -> it is applied to the Projection -> a new Snapshot is published ->
/// RobotSequencer calls on_durable(). Entries are applied only after they are durable, so the maps never contain more
/// than the log. The strand yields after each slice of work, so the scans of one session do not delay those of another.
///
/// Threads: every public function may be called from any thread; the work runs on the strand.
class Session : public std::enable_shared_from_this<Session> {
public:
    /// Creates a session from the maps of its whole log. Call correct_maps() then.
    ///
    /// @param checkpointed  revision of the stored checkpoint, as Recovered::checkpointed
    /// @param log  must outlive the session
    /// @param compute  applies entries
    /// @param blocking_executor  writes checkpoints, which blocks; `compute` by default
    Session(SessionInfo info, localization::LocalizedProjection maps, std::optional<Revision> checkpointed,
            store::ScanLog& log, boost::asio::any_io_executor compute,
            std::shared_ptr<SessionCounters> counters = std::make_shared<SessionCounters>(),
            const SessionLimits& limits = {},
            std::optional<boost::asio::any_io_executor> blocking_executor = std::nullopt);

    [[nodiscard]] const SessionInfo& info() const noexcept { return info_; }

    /// Returns the newest maps, which contain every scan acknowledged so far. Waits about a millisecond if the maps are
    /// being changed in place.
    [[nodiscard]] std::shared_ptr<const mapping::Snapshot> snapshot() const { return maps_.published().get(); }

    /// Returns the newest maps, or null if they are being changed in place. Does not wait.
    [[nodiscard]] std::shared_ptr<const mapping::Snapshot> try_snapshot() const { return maps_.published().try_get(); }

    /// Returns MainBounds::of() the newest maps.
    [[nodiscard]] grid::CellBox main_bounds() const { return main_bounds_.of(*snapshot()); }

    /// Returns the number of entries that wait to be appended to the log.
    [[nodiscard]] std::size_t backlog_size() const noexcept { return backlog_size_; }

    /// Returns Snapshot::moving_scans of the newest maps. Does not wait.
    [[nodiscard]] std::size_t moving_scans() const noexcept { return moving_scans_; }

    /// Returns the error that stopped ingestion, or nullopt if the session accepts scans.
    ///
    /// After a failure the session still serves its last maps but accepts no scans until it is loaded again from the
    /// store. If memory ran out, the maps may show a partially integrated scan.
    [[nodiscard]] std::optional<Error> failure() const;

    /// Returns why the session is closing, or nullopt if it is not: kGone if it is deleted, kNotOwner if another server
    /// goes on with it or has taken it, otherwise kShuttingDown. A closing session accepts no further entries.
    [[nodiscard]] std::optional<Error> closing() const;

    /// Calls `read` with the estimated poses of the scans that robots sent without, on the session's strand.
    /// @param read  must not block
    void read_poses(std::function<void(const localization::SessionPoses&)> read);

    /// Searches for a robot's next scan near a place: appends the entry to the log.
    /// @param done  receives, on the session's strand, success when the entry waits to be appended, or kNotFound if the
    ///              robot has not joined, kConflict if it sends poses, or why the session accepts no entries
    void relocalize(const RobotRelocalized& relocalized, std::function<void(Result<>)> done);

    /// Turns localize-only mode on or off for the scans that arrive from now on: appends the entry to the log.
    /// @param done  receives, on the session's strand, success when the entry waits to be appended or the mode is that
    ///              already, or kConflict if the robots cannot map together, or why the session accepts no entries
    void change_mode(const ModeChanged& changed, std::function<void(Result<>)> done);

    /// Begins to correct the maps if they show scans at poses that have been corrected.
    void correct_maps();

    /// Adds a watcher, which is notified of each change of the state that this class returns. A watcher that reads the
    /// state after this call misses no change.
    void watch(std::weak_ptr<Watcher> watcher) { watchers_.add(std::move(watcher)); }

    /// Notifies the watchers that data which another component keeps about this session has changed.
    void notify_changed() const { watchers_.notify(); }

    /// Returns whether the robot is connected.
    [[nodiscard]] bool is_connected(RobotIndex robot) const { return sequencer_.is_connected(robot); }

    /// Returns whether each robot is connected, by RobotIndex. Robots beyond the end are not connected.
    [[nodiscard]] std::vector<bool> connected() const { return sequencer_.connected(); }

    /// Connects a robot to this session and replaces its previous connection, if any.
    ///
    /// The previous connection fails with kReplaced. `done` runs once, on the session's strand, after all entries that
    /// the previous connections submitted are durable. Therefore Joined::last_durable_seq is exact, and the credit of
    /// at most one connection is outstanding.
    ///
    /// @param listener  receives acknowledgements and errors; kept until leave() or on_failed()
    /// @param done  receives the result, or one of
    ///              kReplaced (a newer connection of this robot arrived first), kConflict (the robot's scans come from
    ///              another source), kFull (the session has 1024 robots), kGone (deleted), kStoreFailed, kOverloaded,
    ///              kNotOwner, kShuttingDown
    void join(JoinRequest who, std::shared_ptr<RobotListener> listener, std::function<void(Result<Joined>)> done);

    /// Describes a sensor, for the scans that are submitted after it.
    ///
    /// Ignored if `from` has not joined or has failed. The link fails with kInvalidField if the range of the sensor
    /// spans too many cells.
    /// @param bytes  credit, returned by RobotListener::on_durable()
    void submit(std::shared_ptr<RobotListener> from, Sensor sensor, std::size_t bytes);

    /// Submits scans. Scans that the log already contains are dropped.
    ///
    /// Ignored if `from` has not joined or has failed. The link fails with kOutOfOrder if a scan is missing,
    /// kInvalidField if its sensor was not described, its beams do not fit the sensor or it needs too much work,
    /// kConflict if it should begin the map of a session that contains one already, kFull if it might need more chunks
    /// than the map may have, and kOverloaded if the memory for maps is used up. The scans before it are kept.
    /// @param bytes  credit, returned by RobotListener::on_durable()
    void submit(std::shared_ptr<RobotListener> from, std::vector<Scan> scans, std::size_t bytes);

    /// Disconnects a link. The entries that it submitted are kept.
    void leave(std::shared_ptr<RobotListener> listener);

    /// Stops accepting entries. When all submitted entries are durable and applied, writes a checkpoint, gives the
    /// session up if several servers share the log, fails every link with `reason` and calls `done`.
    void close(Error reason, std::function<void()> done);

    /// Makes close() end soon: drops entries that are not durable, acknowledges the durable ones, which the next
    /// recovery applies, and writes no further piece of a checkpoint.
    void finish_early();

    /// Closes the session as close() after finish_early(), but does not give it up. Used when its maps are no longer
    /// needed.
    void close_early(Error reason, std::function<void()> done);

private:
    void on_strand(std::function<void(Session&)> work);

    [[nodiscard]] bool is_mapped() const;
    void enqueue(std::vector<PendingEntry> entries);
    void append_next();
    void append(Group group);
    void refuse_first(const Error& error);
    void on_appended(Group group, const Result<>& appended);
    void apply_batch();
    [[nodiscard]] Result<> apply_entries(double work);
    void count(const ScanTaken& applied);
    void count_loops();
    void log_localization();
    [[nodiscard]] Group take_applied_group();
    void report_places(const Group& group);
    void notify_watchers();
    void stop_writing(const Error& error);
    void reset_to_durable(const Error& error);
    void finish_reset();
    void drop_pending();
    void begin_checkpoint();
    void begin_correction();
    void continue_correction();
    void on_corrected(const Result<>& applied);
    void drop_correction();
    void finish_closing();

    SessionInfo info_;
    store::ScanLog& log_;
    const std::shared_ptr<SessionCounters> counters_;
    const SessionLimits limits_;
    boost::asio::any_io_executor blocking_executor_;
    boost::asio::strand<boost::asio::any_io_executor> strand_;
    RobotSequencer sequencer_;

    // On the strand only.
    SessionMaps maps_; // published() on any thread
    Backlog waiting_;
    std::deque<Group> durable_; // not applied yet; the first one may be applied in part
    std::size_t applied_ = 0;   // applied entries of the first group
    Revision appended_ = 0;     // newest entry passed to the log
    bool appending_ = false;
    std::int64_t chunks_under_way_ = 0;         // that the groups being appended or applied may create
    limits::MemoryShare share_;                 // of the limits' budgets: pages_ and chunks_under_way_
    std::size_t pages_ = 0;                     // of the maps
    std::shared_ptr<MapCorrection> correction_; // null: none is being made, nor waits for its entry
    std::size_t correction_pages_ = 0;          // of share_
    std::size_t loops_ = 0;                     // of all robots, that are counted
    slam::LoopFigures loop_figures_;            // likewise
    std::set<std::string> warned_of_;           // robots whose lasers' mounts seem to be wrong
    std::set<std::string> lost_;                // robots that are lost
    CheckpointSchedule checkpoints_;
    bool final_checkpoint_tried_ = false;
    std::optional<Error> refusing_; // why no more entries are accepted
    bool resetting_ = false;        // to the durable entries, because the log had no room for more
    bool broken_ = false;           // the log or the memory failed: no more appending, applying or checkpoints
    std::function<void()> closed_;  // called when closing is done

    std::atomic<bool> stays_owned_ = false;  // close() does not give it up
    bool has_news_ = true;                   // a change to notify, not counting connections
    std::uint64_t connections_reported_ = 0; // RobotSequencer::connection_changes() at the last notification

    mutable Watchers watchers_;
    std::atomic<bool> finish_early_ = false;    // set from any thread, because the strand may be busy
    std::atomic<std::size_t> backlog_size_ = 0; // of waiting_, for any thread
    std::atomic<std::size_t> moving_scans_ = 0; // of maps_, for any thread

    MainBounds main_bounds_;

    mutable std::mutex failure_mutex_; // guards the members below; held briefly
    std::optional<Error> failure_;
    std::optional<Error> closing_;
};

} // namespace scanloom::sessions
