#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_entry.hpp"
#include "server/mapping/projection.hpp"
#include "server/session/backlog.hpp"
#include "server/session/members.hpp"
#include "server/session/page_share.hpp"
#include "server/session/published.hpp"
#include "server/session/robot_listener.hpp"
#include "server/session/session_info.hpp"
#include "server/session/watchers.hpp"
#include "server/store/scan_log.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/strand.hpp>

#include <atomic>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::session {

/// One session: the single writer of its log and of the maps woven from it.
///
/// A scan goes down: submit() -> (strand) Members: checked against what came before -> Backlog -> appended
/// to the ScanLog in groups -> durable -> folded into the Projection -> a new Snapshot published -> Members:
/// on_durable(). Nothing is folded before it is durable, so that the maps never know more than the log.
/// Folding gives way after each slice of work: one session's scans hold up no other's.
///
/// Thread  every public function may be called from any thread; the work happens on the strand.
class Session : public std::enable_shared_from_this<Session> {
public:
    /// A session whose projection has been recovered from the log up to its end.
    /// `checkpointed` is the revision that its stored checkpoint holds, as in Recovered. Checkpoints are written on
    /// `may_wait`, by default on `compute`, which they would hold up.
    Session(SessionInfo info, mapping::Projection projection, std::optional<Revision> checkpointed, store::ScanLog& log,
            boost::asio::any_io_executor compute,
            std::shared_ptr<SessionCounters> counters = std::make_shared<SessionCounters>(),
            const SessionLimits& limits = {}, std::optional<boost::asio::any_io_executor> may_wait = std::nullopt);

    [[nodiscard]] const SessionInfo& info() const noexcept { return info_; }

    /// The newest maps; they hold every scan acknowledged so far. Waits about a millisecond where they are being
    /// written.
    [[nodiscard]] std::shared_ptr<const mapping::Snapshot> snapshot() const { return published_.get(); }

    /// The same for threads that may not wait: null where they are being written.
    [[nodiscard]] std::shared_ptr<const mapping::Snapshot> try_snapshot() const { return published_.try_get(); }

    /// mapping::main_bounds_of() the newest maps. Found once for each revision: a few milliseconds.
    [[nodiscard]] grid::CellBox main_bounds() const;

    /// Entries that wait to be handed to the log.
    [[nodiscard]] std::size_t backlog_size() const noexcept { return backlog_size_; }

    /// Why the session takes no scans until it is read from the store again, its maps being served all the same: the
    /// log could not be written, or the memory ran out, of which scan a part may show. Nothing while all is well.
    [[nodiscard]] std::optional<Error> failure() const;

    /// Why the session takes nothing more, since it is being closed: kGone, it is deleted, or kShuttingDown. Nothing
    /// before that.
    [[nodiscard]] std::optional<Error> closing() const;

    /// From now on tells `watcher` when any of what can be asked for here has changed. Whoever watches first and then
    /// looks misses nothing.
    void watch(std::weak_ptr<Watcher> watcher) { watchers_.add(std::move(watcher)); }

    /// Tells the watchers that something has changed which others keep about this session.
    void tell_changed() const { watchers_.tell(); }

    /// Whether the robot has a link at present.
    [[nodiscard]] bool is_connected(RobotIndex robot) const { return members_.is_connected(robot); }

    /// The same of all, by RobotIndex; those beyond the end have none.
    [[nodiscard]] std::vector<bool> connected() const { return members_.connected(); }

    /// Makes `listener` the robot's link; an earlier link of the same robot fails with kReplaced.
    /// `done` is called once, on the strand, when everything the robot's earlier links submitted is
    /// durable: so last_durable_seq is exact, and no more than one link's credit is under way.
    /// Errors  kReplaced, kConflict (the robot's scans come from another source), kGone, kStoreFailed,
    ///         kShuttingDown, kFull.
    void join(Newcomer who, std::shared_ptr<RobotListener> listener, std::function<void(Result<Joined>)> done);

    /// Describes a sensor, for the scans submitted after it. What comes from a link that has not joined
    /// yet, or has failed, is ignored, here and below. `bytes` is given back through on_durable.
    void submit(std::shared_ptr<RobotListener> from, Sensor sensor, std::size_t bytes);

    /// Adds scans. Those the log already has are dropped; a missing one fails the link (kOutOfOrder),
    /// as do a scan of a sensor that was not described or with beams that do not fit it, and one that might
    /// need more chunks than a map may have (kFull).
    void submit(std::shared_ptr<RobotListener> from, std::vector<Scan> scans, std::size_t bytes);

    /// The link is gone; what it submitted stays.
    void leave(std::shared_ptr<RobotListener> listener);

    /// Takes nothing more; when all that was submitted is durable and folded, fails every link with
    /// `reason`, writes a checkpoint and calls `done`.
    void close(Error reason, std::function<void()> done);

    /// Lets close() end soon: what is not durable yet is dropped; what is durable is acknowledged, and folded by the
    /// next recovery; no further piece of a checkpoint is written.
    void hurry();

    /// Closes a session that is to be deleted: close() in a hurry.
    void discard(Error reason, std::function<void()> done);

private:
    template <class Work>
    void on_strand(Work work);

    void enqueue(std::vector<Submitted> entries);
    void append_next();
    void append(Group group);
    void refuse_first(const Error& error);
    void on_appended(Group group, const Result<>& appended);
    void fold_slice();
    [[nodiscard]] Result<> fold_some(double work);
    void count_and_keep(ScanTaken& folded);
    void finish_group();
    [[nodiscard]] Result<> publish();
    void tell_watchers();
    void stop_writing(const Error& error);
    void set_back(const Error& error);
    void finish_setting_back();
    void drop_what_is_under_way();
    [[nodiscard]] bool is_checkpoint_due() const;
    void begin_checkpoint();
    void finish_closing();

    SessionInfo info_;
    store::ScanLog& log_;
    const std::shared_ptr<SessionCounters> counters_;
    const SessionLimits limits_;
    boost::asio::any_io_executor may_wait_;
    boost::asio::strand<boost::asio::any_io_executor> strand_;
    Members members_;

    // On the strand only.
    mapping::Projection projection_;
    Backlog waiting_;
    std::deque<Group> durable_; // not folded yet; the first one may be in part
    std::size_t folded_ = 0;    // entries of the first
    std::vector<std::shared_ptr<const mapping::FoldedScan>> newest_scans_; // by RobotIndex; null: none yet
    Revision appended_ = 0;                                                // newest entry handed to the log
    bool appending_ = false;
    std::int64_t chunks_under_way_ = 0; // that the groups being appended and folded may add
    PageShare share_;                   // of the limits' budgets: what the maps take, and what is under way
    std::size_t pages_ = 0;             // that the maps take
    std::optional<Revision> checkpointed_;
    double work_since_checkpoint_ = 0.0;
    std::size_t described_since_checkpoint_ = 0; // bytes of sensor descriptions
    bool checkpointing_ = false;
    bool final_checkpoint_tried_ = false;
    std::optional<Error> refusing_; // why nothing more is taken
    bool setting_back_ = false;     // to what is durable, as the log had no room for more
    bool broken_ = false;           // the log or the memory failed: nothing more is appended, folded or written
    std::function<void()> closed_;  // to be called when closing is done

    bool has_news_ = false;              // for the watchers, besides links that came or went
    std::uint64_t connections_told_ = 0; // Members::connection_changes() that the watchers know of

    mutable Watchers watchers_;
    std::atomic<bool> hurried_ = false;         // set from any thread, as the strand may be busy
    std::atomic<std::size_t> backlog_size_ = 0; // of waiting_, for any thread

    Published published_;

    mutable std::mutex main_bounds_mutex_; // guards what follows
    mutable grid::CellBox main_bounds_;
    mutable std::optional<Revision> main_bounds_at_;

    mutable std::mutex failure_mutex_; // guards what follows, held for a copy only
    std::optional<Error> failure_;
    std::optional<Error> closing_;
};

} // namespace scanloom::session
