#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_rules.hpp"
#include "core/localization/robot_poses.hpp"
#include "core/mapping/projection.hpp"
#include "server/sessions/backlog.hpp"
#include "server/sessions/listeners.hpp"
#include "server/sessions/session_info.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::sessions {

/// A new link that waits until the entries of the robot's earlier links are in the maps.
struct PendingJoin {
    JoinRequest who;
    std::shared_ptr<RobotListener> listener;
    std::function<void(Result<Joined>)> done;
};

/// Robot sequencer: checks the order and the duplicates of the entries that a session's robots send on their links.
///
/// Every entry that it returns can be appended to the log in the order of the calls.
/// Threads: the session's strand; is_connected() and connected() any thread.
class RobotSequencer {
public:
    /// `info` and `counters` must outlive this object.
    RobotSequencer(const SessionInfo& info, SessionCounters& counters) : info_(info), counters_(counters) {}

    /// Resets all robots to the state of the log and forgets entries that are not durable.
    void restore(const mapping::ProjectionState& state);

    [[nodiscard]] bool is_connected(RobotIndex robot) const;

    /// Returns whether each robot is connected, by RobotIndex. Robots beyond the end are not connected.
    [[nodiscard]] std::vector<bool> connected() const;

    /// Returns a number that increases each time a robot connects or disconnects.
    [[nodiscard]] std::uint64_t connection_changes() const noexcept { return connection_changes_; }

    /// Connects a robot, and fails its earlier link with kReplaced. Calls `joining.done` when all entries of the
    /// earlier links are in the maps.
    /// @return the entry to append if the robot is new or its properties have changed
    [[nodiscard]] std::optional<PendingEntry> join(PendingJoin joining);

    /// Disconnects a link. Ignored if it is not the current link of a robot.
    void leave(const std::shared_ptr<RobotListener>& listener);

    /// Checks the description of a sensor. An invalid one fails the link.
    /// @param bytes  credit to return when the description is in the maps
    /// @return the entries to append; empty if `from` is not the link of a robot
    [[nodiscard]] std::vector<PendingEntry> describe(const std::shared_ptr<RobotListener>& from, Sensor sensor,
                                                     std::size_t bytes);

    /// Checks scans and drops duplicates. An invalid scan fails the link; the scans before it are accepted.
    /// @param bytes  credit to return when the scans are in the maps
    /// @param is_mapped  whether the maps of the session contain anything yet
    /// @return the entries to append; empty if `from` is not the link of a robot
    [[nodiscard]] std::vector<PendingEntry> take(const std::shared_ptr<RobotListener>& from, std::vector<Scan> scans,
                                                 std::size_t bytes, bool is_mapped);

    /// Returns the entry to append when maps follow corrected poses.
    [[nodiscard]] PendingEntry announce(const MapsCorrected& corrected);

    /// Returns the entry to append when an operator says where a robot is.
    /// Errors: kNotFound if the robot has not joined; kConflict if it sends poses.
    [[nodiscard]] Result<PendingEntry> relocalize(const RobotRelocalized& relocalized);

    /// Returns the entry to append when an operator turns localize-only mode on or off; nullopt if it is so already.
    /// Errors: kConflict if mapping is to go on with robots whose poses do not go together.
    [[nodiscard]] Result<std::optional<PendingEntry>> change_mode(const ModeChanged& changed);

    /// Sets where a robot is whose scans have no poses, to estimate what its next scans reach.
    /// @param robot     index in the session
    /// @param location  by its newest scan in the maps
    void set_location(RobotIndex robot, const localization::RobotLocation& location) {
        members_[robot].location = location;
    }

    /// Returns the link of a robot; null if it is not connected.
    /// @param robot  index in the session
    [[nodiscard]] RobotListener* listener_of(RobotIndex robot) const { return members_[robot].listener.get(); }

    /// Acknowledges a group that is in the maps: calls on_durable() of its links, and admits links that waited for it.
    void release(const Group& group);

    /// Fails the robot's link and forgets the robot's entries that are not in `state`.
    void refuse(RobotIndex robot, const Error& error, const mapping::ProjectionState& state);

    /// Fails the links of all robots, also those that wait to join.
    void fail_all(const Error& error);

private:
    struct Member {
        std::shared_ptr<RobotListener> listener;
        std::optional<PendingJoin> joining;
        std::size_t pending_entries = 0; // entries submitted and not released
        std::uint64_t durable_seq = 0;
        std::uint64_t first_visible_seq = 0;  // of the first scan accepted here that can change a cell; 0: none
        localization::RobotLocation location; // see set_location()
    };

    [[nodiscard]] RobotIndex index_of(const Member& member) const;
    [[nodiscard]] const LoggedRobot& logged(const Member& member) const { return pending_.robots()[index_of(member)]; }
    [[nodiscard]] Member* member_of(const std::shared_ptr<RobotListener>& listener);
    [[nodiscard]] PendingEntry submitted(Member& member, std::optional<LogEntry> entry, std::size_t bytes);
    [[nodiscard]] Result<> check_again(const LoggedRobot& robot, const JoinRequest& who) const;
    [[nodiscard]] Result<> check_frame(const std::string& robot, Poses poses) const;
    [[nodiscard]] mapping::Reach reach_of(const Member& member, Scan& scan) const;
    [[nodiscard]] static Result<> check_pose(const LoggedRobot& robot, const Scan& scan);
    [[nodiscard]] Result<> check_next(const LoggedRobot& robot, const Scan& scan, bool is_mapped) const;
    void restore(RobotIndex robot, const LoggedRobot& durable);
    void admit(Member& member);
    void fail(Member& member, const Error& error);
    void set_connected(const Member& member, bool connected);

    const SessionInfo& info_;
    SessionCounters& counters_;
    LogRules pending_;            // the robots as in the log after all submitted entries are appended
    std::vector<Member> members_; // by RobotIndex, as many as pending_.robots()
    std::uint64_t connection_changes_ = 0;

    mutable std::mutex connected_mutex_;
    std::vector<bool> connected_;
};

} // namespace scanloom::sessions
