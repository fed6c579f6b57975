#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_entry.hpp"
#include "server/mapping/projection.hpp"
#include "server/store/scan_log.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/strand.hpp>

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::session {

/// What a session is, for as long as it exists.
struct SessionInfo {
    store::SessionId id = 0;
    std::string name;
    double created = 0.0; ///< seconds since the epoch
    mapping::MapConfig config;
};

/// What all sessions count together. Thread: any.
struct SessionCounters {
    std::atomic<std::uint64_t> scans_applied = 0;    ///< in the log and in the map
    std::atomic<std::uint64_t> scans_duplicates = 0; ///< sent again after a reconnect and dropped
};

/// What a session tells the link of a robot. Called on the session's strand: hand over, do not block.
class RobotListener {
public:
    virtual ~RobotListener() = default;

    /// Every scan up to durable_seq is in the log and in the map; `bytes` more of what was submitted
    /// need no credit any longer.
    virtual void on_durable(std::uint64_t durable_seq, std::size_t bytes) = 0;

    /// The session will take nothing more from this link.
    virtual void on_failed(const Error& error) = 0;
};

/// What a robot learns when it joins.
struct Joined {
    RobotIndex robot = 0;
    std::uint64_t last_durable_seq = 0;
};

/// One session: the single writer of its log and of the maps woven from it.
///
/// A scan goes down: submit() -> (strand) checked against what came before -> appended to the ScanLog
/// in groups -> durable -> folded into the Projection -> a new Snapshot published -> on_durable().
/// Nothing is folded before it is durable, so that the maps never know more than the log.
///
/// Thread  every public function may be called from any thread; the work happens on the strand.
class Session : public std::enable_shared_from_this<Session> {
public:
    /// A session whose projection has been recovered from the log up to its end.
    /// `checkpointed` is the revision that its stored checkpoint holds.
    Session(SessionInfo info, mapping::Projection projection, Revision checkpointed, store::ScanLog& log,
            boost::asio::any_io_executor compute,
            std::shared_ptr<SessionCounters> counters = std::make_shared<SessionCounters>());

    [[nodiscard]] const SessionInfo& info() const noexcept { return info_; }

    /// The newest maps; they hold every scan acknowledged so far.
    [[nodiscard]] std::shared_ptr<const mapping::Snapshot> snapshot() const;

    /// Whether the robot has a link at present.
    [[nodiscard]] bool is_connected(RobotIndex robot) const;

    /// Makes `listener` the robot's link; an earlier link of the same robot fails with kReplaced.
    /// `done` is called once, on the strand, when everything the robot's earlier links submitted is
    /// durable: so last_durable_seq is exact, and no more than one link's credit is under way.
    /// Errors  kReplaced, kGone, kStoreFailed, kShuttingDown, kTooLarge.
    void join(std::string robot, std::shared_ptr<RobotListener> listener, std::function<void(Result<Joined>)> done);

    /// Describes a sensor, for the scans submitted after it. What comes from a link that has not joined
    /// yet, or has failed, is ignored, here and below. `bytes` is given back through on_durable.
    void submit(std::shared_ptr<RobotListener> from, Sensor sensor, std::size_t bytes);

    /// Adds scans. Those the log already has are dropped; a missing one fails the link (kOutOfOrder),
    /// as do a scan of a sensor that was not described or with beams that do not fit it.
    void submit(std::shared_ptr<RobotListener> from, std::vector<Scan> scans, std::size_t bytes);

    /// The link is gone; what it submitted stays.
    void leave(std::shared_ptr<RobotListener> listener);

    /// Takes nothing more; when all that was submitted is durable and folded, fails every link with
    /// `reason`, writes a checkpoint and calls `done`.
    void close(Error reason, std::function<void()> done);

private:
    /// What came in one frame of one robot: entries for the log, and the credit they hold.
    struct Submission {
        RobotIndex robot = 0;
        std::vector<LogEntry> entries;
        std::size_t bytes = 0;
    };
    using Group = std::vector<Submission>;

    /// A link that waits until what the robot's earlier links submitted is durable.
    struct Joining {
        std::shared_ptr<RobotListener> listener;
        std::function<void(Result<Joined>)> done;
    };

    /// A robot's link and what has been received from it, durable or not yet.
    struct Member {
        std::string name;
        std::shared_ptr<RobotListener> listener;
        std::optional<Joining> joining;
        std::size_t under_way = 0; // submissions enqueued and not released
        std::uint64_t received_seq = 0;
        std::uint64_t durable_seq = 0;
        std::map<std::uint32_t, Sensor> sensors;
    };

    template <class Work>
    void on_strand(Work work);

    void do_join(const std::string& robot, Joining joining);
    void admit(RobotIndex robot);
    [[nodiscard]] Member* member_of(const std::shared_ptr<RobotListener>& listener);
    void describe(Member& member, Sensor sensor, std::size_t bytes);
    void take(Member& member, std::vector<Scan> scans, std::size_t bytes);
    [[nodiscard]] Result<> check_next(const Member& member, const Scan& scan) const;
    void enqueue(Submission submission);
    void append_next();
    void on_appended(Group group, const Result<>& appended);
    [[nodiscard]] Result<> fold(const Group& group);
    [[nodiscard]] Result<> fold_guarded(const Group& group);
    void release(const Group& group);
    void publish();
    void fail(Member& member, const Error& error);
    void fail_all(const Error& error);
    void stop_writing(const Error& error);
    void forget_what_is_not_durable();
    void set_connected(RobotIndex robot, bool connected);
    void write_checkpoint();
    void finish_closing();

    SessionInfo info_;
    store::ScanLog& log_;
    const std::shared_ptr<SessionCounters> counters_;
    boost::asio::strand<boost::asio::any_io_executor> strand_;

    // On the strand only.
    mapping::Projection projection_;
    std::vector<Member> members_;    // by RobotIndex
    std::deque<Submission> waiting_; // bounded by the links' credits
    Revision appended_ = 0;          // newest entry handed to the log
    bool appending_ = false;
    Revision checkpointed_ = 0;
    bool checkpointing_ = false;
    bool final_checkpoint_tried_ = false;
    std::optional<Error> refusing_; // why nothing more is taken
    bool broken_ = false;           // the log failed: what it holds is unknown, nothing more is written
    std::function<void()> closed_;  // to be called when closing is done

    mutable std::mutex published_mutex_; // guards the two below, held for a copy only
    std::shared_ptr<const mapping::Snapshot> published_;
    std::vector<bool> connected_;
};

} // namespace scanloom::session
