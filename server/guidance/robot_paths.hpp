#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/log_entry.hpp"
#include "server/sessions/session.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <vector>

/// The goals and paths that robots hold. Positions and lengths are in metres of the map frame. A revision is that of
/// the maps that were searched.
namespace scanloom::guidance {

struct Goal {
    Point2 place{0.0, 0.0};  ///< where the robot should stand
    Point2 target{0.0, 0.0}; ///< what the robot should observe
    bool in_danger = false;  ///< `place` is in danger, because no other place was found
    Revision revision = 0;
};

enum class PathKind { kGoal, kPlan, kCoverage };

struct HeldPath {
    PathKind kind = PathKind::kGoal;
    std::vector<Point2> points;
    double length_m = 0.0; ///< of the whole path, also of points left out
    Revision revision = 0;
    std::size_t points_left_out = 0; ///< number of points that follow `points`
};

/// Keeps the goal of each robot of a session and the path it planned last, for display.
///
/// A robot holds its goal and path until it is given others or has left. What was given to a robot that was not
/// connected is held until the robot has connected and left, or for kKeptForAbsent. Nothing outlives the server process
/// or the Session object. If a robot has explored everything it can reach, this is stored until it
/// asks for a goal again, also after it has left. Other robots that have left are removed at the next read.
///
/// Bounds: at most one goal and one path for each robot of a session, kShownPathPointsMax points for each path, about
///     kSessionPathPointsMax points for each session.
/// Threads: any thread; no lock is held during a search.
class RobotPaths {
public:
    using Clock = std::chrono::steady_clock;

    static constexpr Clock::duration kKeptForAbsent = std::chrono::minutes(1);
    static constexpr std::size_t kShownPathPointsMax = 16'384;
    static constexpr std::size_t kSessionPathPointsMax = std::size_t{1} << 20; ///< paths beyond keep two points

    /// Whether the page of a session has changed, or will.
    struct State {
        std::uint64_t revision = 0;                         ///< increases with each change; 0: nothing was given yet
        Clock::time_point until = Clock::time_point::max(); ///< the page may change by itself after this time
    };

    struct Held {
        RobotIndex robot = 0;
        std::optional<Goal> goal;
        std::shared_ptr<const HeldPath> path; ///< null: none was found
    };

    struct Page {
        std::uint64_t revision = 0;
        std::vector<Held> robots;         ///< robots that hold a goal or a path, by RobotIndex
        std::vector<RobotIndex> explored; ///< robots whose last request found no goal left to reach, ascending
    };

    using SessionPtr = std::shared_ptr<const sessions::Session>;

    /// Gives a robot a goal and the path to it, which replace everything the robot held. Like every change, this
    /// notifies the session's watchers.
    /// @return a number that identifies this goal in the session; see holds()
    std::uint64_t give_goal(const SessionPtr& session, RobotIndex robot, const Goal& goal, HeldPath path,
                            Clock::time_point now);

    /// Replaces the path of a robot by the one that it requested over its connection. Its goal stays.
    /// @param path  nullopt: no path was found
    void set_path(const SessionPtr& session, RobotIndex robot, std::optional<HeldPath> path, Clock::time_point now);

    /// Removes everything that a robot holds.
    /// @param explored  whether the reason is that the robot can reach nothing left to explore
    void take_back(const SessionPtr& session, RobotIndex robot, bool explored = false);

    /// Returns whether the robot still holds a goal.
    /// @param goal  the result of give_goal()
    [[nodiscard]] bool holds(const SessionPtr& session, RobotIndex robot, std::uint64_t goal, Clock::time_point now);

    [[nodiscard]] State state(const SessionPtr& session, Clock::time_point now);
    [[nodiscard]] Page page(const SessionPtr& session, Clock::time_point now);

private:
    struct Holding {
        Clock::time_point given;
        bool was_connected;
        std::optional<Goal> goal;
        std::uint64_t goal_given; // Record::revision when the goal was given
        std::shared_ptr<const HeldPath> path;
    };

    struct Record {
        std::uint64_t revision = 0;
        std::map<RobotIndex, Holding> holdings;
        std::set<RobotIndex> explored;
    };

    [[nodiscard]] Record& record_of(const SessionPtr& session);
    [[nodiscard]] Record* find(const SessionPtr& session, Clock::time_point now);
    [[nodiscard]] static std::shared_ptr<const HeldPath> bounded(const Record& record, HeldPath path);
    static void remove_expired(Record& record, const sessions::Session& session, Clock::time_point now);

    std::mutex mutex_;
    std::map<std::weak_ptr<const sessions::Session>, Record, std::owner_less<>> records_;
};

} // namespace scanloom::guidance
