#pragma once

#include "common/error/error.hpp"
#include "server/mapping/projection.hpp"
#include "server/session/backlog.hpp"
#include "server/session/robot_listener.hpp"
#include "server/session/session_info.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::session {

/// A link that waits until what the robot's earlier links submitted is in the maps.
struct Joining {
    Newcomer who;
    std::shared_ptr<RobotListener> listener;
    std::function<void(Result<Joined>)> done;
};

/// The robots of a session, their links, and what each of them has sent: only entries that can follow
/// in the log come out of here.
/// Thread  the session's strand; is_connected() and connected() any.
class Members {
public:
    /// Both must outlive this.
    Members(const SessionInfo& info, SessionCounters& counters) : info_(info), counters_(counters) {}

    /// Takes the log's word for what each robot has sent: whatever is not durable is forgotten.
    void restore(const mapping::ProjectionState& state);

    [[nodiscard]] bool is_connected(RobotIndex robot) const;

    /// By RobotIndex; those beyond the end are not connected.
    [[nodiscard]] std::vector<bool> connected() const;

    /// Rises whenever a robot's link comes or goes.
    [[nodiscard]] std::uint64_t connection_changes() const noexcept { return connection_changes_; }

    /// Lets the link in as soon as nothing of the robot's earlier ones is under way; these fail.
    /// @return the entry that makes the robot known, if it is not as it says it is.
    [[nodiscard]] std::optional<Submitted> join(Joining joining);

    void leave(const std::shared_ptr<RobotListener>& listener);

    /// @return what to append; nothing from a link that is not a robot's. A fault fails the link.
    [[nodiscard]] std::vector<Submitted> describe(const std::shared_ptr<RobotListener>& from, Sensor sensor,
                                                  std::size_t bytes);
    /// @param is_mapped  whether anything of the session is in the maps yet
    [[nodiscard]] std::vector<Submitted> take(const std::shared_ptr<RobotListener>& from, std::vector<Scan> scans,
                                              std::size_t bytes, bool is_mapped);

    /// The group is in the maps: tells the links, gives back their credit, lets in who waited for that.
    void release(const Group& group);

    /// Fails the robot's link and forgets whatever of it is not in the state.
    void refuse(RobotIndex robot, const Error& error, const mapping::ProjectionState& state);

    void fail_all(const Error& error);

private:
    struct Member {
        LoggedRobot robot; // as the log will have it when all that was submitted is in it
        std::shared_ptr<RobotListener> listener;
        std::optional<Joining> joining;
        std::size_t under_way = 0; // entries submitted and not released
        std::uint64_t durable_seq = 0;
        std::uint64_t showed_seq = 0; // of the first scan taken here that shows anything; 0: there is none
    };

    [[nodiscard]] RobotIndex index_of(const Member& member) const;
    [[nodiscard]] Member* member_of(const std::shared_ptr<RobotListener>& listener);
    [[nodiscard]] Submitted submitted(Member& member, std::optional<LogEntry> entry, std::size_t bytes);
    [[nodiscard]] Result<> check_source(const Member& member, const std::string& source) const;
    [[nodiscard]] Result<> check_next(const Member& member, const Scan& scan, bool is_mapped) const;
    void restore(Member& member, const LoggedRobot& logged);
    void admit(Member& member);
    void fail(Member& member, const Error& error);
    void set_connected(const Member& member, bool connected);

    const SessionInfo& info_;
    SessionCounters& counters_;
    std::vector<Member> members_; // by RobotIndex
    std::uint64_t connection_changes_ = 0;

    mutable std::mutex connected_mutex_;
    std::vector<bool> connected_;
};

} // namespace scanloom::session
