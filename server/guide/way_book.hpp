#pragma once

#include "common/scan/log_entry.hpp"
#include "server/guide/way.hpp"
#include "server/session/session.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <vector>

namespace scanloom::guide {

/// Where each robot of a session was told to go, and the way it planned last: for whoever looks on.
///
/// A robot holds what it was given until it is given something else, or has left. What was given to a robot that was
/// not connected is held until the robot has connected and left, or for kKeptForAbsent. Nothing of it survives a
/// restart, or its session. That a robot has explored all it can reach is told on when it has left, until it asks anew.
/// Robots that left are noticed when anybody asks; nobody has to wait for that.
///
/// Bounds  at most a goal and a way for each robot of a session, kWayPointsMax points a way, about kPointsMax a
/// session.
/// Thread  any; held for no search.
class WayBook {
public:
    using Clock = std::chrono::steady_clock;

    static constexpr Clock::duration kKeptForAbsent = std::chrono::minutes(1);
    static constexpr std::size_t kWayPointsMax = 16'384;
    static constexpr std::size_t kPointsMax = std::size_t{1} << 20; ///< a way beyond them has its two first points

    /// How things stand with a session.
    struct State {
        std::uint64_t revision = 0; ///< rises whenever anything of it changes; 0: nothing was given yet
        Clock::time_point until = Clock::time_point::max(); ///< it may change by itself then
    };

    struct Held {
        RobotIndex robot = 0;
        std::optional<Goal> goal;
        std::shared_ptr<const Way> way; ///< null: it asked for one in vain
    };

    struct Page {
        std::uint64_t revision = 0;
        std::vector<Held> robots;         ///< those that hold anything, by RobotIndex
        std::vector<RobotIndex> explored; ///< those that asked for a goal last when none was left to reach, ascending
    };

    using SessionPtr = std::shared_ptr<const session::Session>;

    /// The robot holds a goal and the way there, and nothing else. Tells the session's watchers, as all that changes
    /// something does.
    /// @return what tells this goal from all others of the session; see holds()
    std::uint64_t give_goal(const SessionPtr& session, RobotIndex robot, const Goal& goal, Way way,
                            Clock::time_point now);

    /// The way that the robot asked for over its link takes the place of the one it had; null: there is none. Its goal
    /// stays.
    void give_way(const SessionPtr& session, RobotIndex robot, std::optional<Way> way, Clock::time_point now);

    /// The robot holds nothing any more.
    /// @param explored  whether that is because nothing is left that it could explore
    void take_back(const SessionPtr& session, RobotIndex robot, bool explored = false);

    [[nodiscard]] bool holds(const SessionPtr& session, RobotIndex robot, std::uint64_t goal, Clock::time_point now);

    [[nodiscard]] State state(const SessionPtr& session, Clock::time_point now);
    [[nodiscard]] Page page(const SessionPtr& session, Clock::time_point now);

private:
    struct Holding {
        Clock::time_point given;
        bool was_connected;
        std::optional<Goal> goal;
        std::uint64_t goal_given; // Record::revision then
        std::shared_ptr<const Way> way;
    };

    struct Record {
        std::uint64_t revision = 0;
        std::map<RobotIndex, Holding> holdings;
        std::set<RobotIndex> explored;
    };

    [[nodiscard]] Record& record_of(const SessionPtr& session);
    [[nodiscard]] Record* find(const SessionPtr& session, Clock::time_point now);
    [[nodiscard]] static std::shared_ptr<const Way> bounded(const Record& record, Way way);
    static void forget_what_is_over(Record& record, const session::Session& session, Clock::time_point now);

    std::mutex mutex_;
    std::map<std::weak_ptr<const session::Session>, Record, std::owner_less<>> records_;
};

} // namespace scanloom::guide
