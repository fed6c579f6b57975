#pragma once

#include "core/mapping/snapshot.hpp"
#include "core/planning/goals.hpp"
#include "server/guidance/robot_paths.hpp"
#include "server/sessions/session.hpp"

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

namespace scanloom::guidance {

/// These limits decide whether a robot has been at its goal and has observed its target.
inline constexpr double kArrivedCells = 2.0;                     ///< a scan this near was taken at the goal, or
                                                                 ///< one within the body's radius
inline constexpr double kLookingWithin = std::numbers::pi / 4.0; ///< radians between heading and direction
inline constexpr double kOnTargetCells = 0.75;                   ///< nearer to the target, the direction is ignored
inline constexpr double kLookingTakes = 5.0;                     ///< seconds at the goal, with any heading

/// A goal that was assigned to a robot. Metres, map frame.
struct Visit {
    Point2 goal{0.0, 0.0};              ///< where the robot should stand
    Point2 target{0.0, 0.0};            ///< what the robot should observe
    double arrival_radius = 0.0;        ///< metres; see arrival_radius()
    std::uint64_t scans_before = 0;     ///< RobotState::scan_count when the goal was assigned
    std::optional<double> asking_since; ///< stamp of the newest scan at the first request from the goal
};

/// Returns the distance from the goal within which a robot has arrived, in metres: the body's radius, at least
/// kArrivedCells cells.
[[nodiscard]] double arrival_radius(double body_radius_m, double cell_size_m);

/// Returns whether the robot's newest scan was taken at the goal.
[[nodiscard]] bool is_there(const Visit& visit, const mapping::RobotState& robot);

/// Returns whether the robot has observed its target.
///
/// It has if its newest scan was taken at the goal after the goal was assigned, and one of these holds:
/// - The robot faces the target, as seen from the goal or from the robot (the two differ if the target is near).
/// - The robot stands in the target's cell.
/// - The robot's scans show that it has stood at the goal for kLookingTakes since it first asked from there.
///
/// The heading is that of the robot. For a sensor that looks elsewhere, only the time counts.
[[nodiscard]] bool has_looked(const Visit& visit, const mapping::RobotState& robot, double cell_size_m);

/// Assigns each robot of a session its next goal, and no two robots the same frontier.
///
/// A robot's goal counts until the robot asks for the next one, and only while the RobotPaths says that the robot holds
/// it. So it no longer counts after the robot has left; a robot that returns asks again. Goals do not survive a
/// restart. They are stored as positions in the map frame, so goals found in maps with another cell size count as well.
///
/// It also stores frontiers that robots could not observe, so that exploration ends where a frontier cannot be
/// seen (glass, a narrow gap, things too low for the laser). When a robot that has_looked() asks again, the cells that
/// planning::unobservable_cells() returns are excluded from the goals of all robots, as long as they are FRONTIER: each
/// visit changes the map or excludes a cell. A robot that has not looked yet gets the same goal or a better one.
///
/// Maps may also alternate in places away from the robot: beams along a wall clear what beams towards the wall have
/// shown, and those show it again. So cells around targets are also excluded whenever they are FRONTIER again after
/// kLooksMax looks. Excluded cells and looks are kept for each session and the settings of its maps, at most
/// kUnobservedCellsMax cells each. Beyond that, the oldest cells are dropped and looks are counted from 0 again.
///
/// Threads: any thread; one search at a time.
class GoalAssignments {
public:
    using Clock = RobotPaths::Clock;

    static constexpr std::size_t kUnobservedCellsMax = std::size_t{1} << 16;
    static constexpr int kLooksMax = 2;
    static constexpr std::size_t kSettingsMax = 8; ///< of one session; the least recently used are dropped

    /// Finds the next goal of a robot and keeps it for that robot.
    /// @param maps      the session's maps, or the maps of a replay job of its log
    /// @param position  of the robot, metres, map frame
    /// @return the goal, or why there is none
    /// Errors: those of planning::next_goal(); the robot has no goal then.
    [[nodiscard]] Result<planning::NextGoal> next(const std::shared_ptr<const sessions::Session>& session,
                                                  const mapping::Snapshot& maps, RobotIndex robot,
                                                  const Point2& position, Clock::time_point now,
                                                  const planning::ExplorationOptions& options = {});

    /// Returns the goals and paths that robots hold, which include the goals assigned here.
    [[nodiscard]] RobotPaths& paths() noexcept { return paths_; }

private:
    struct Entry {
        std::weak_ptr<const sessions::Session> session;
        RobotIndex robot;
        std::uint64_t given;         // result of RobotPaths::give_goal()
        mapping::MapConfig settings; // settings of the maps
        grid::Cell goal;
        std::vector<grid::Cell> around_target;
        Visit visit;
    };

    using Looks = std::map<std::pair<std::int32_t, std::int32_t>, int>; // number of looks by (j, i)

    struct Unobserved {
        std::weak_ptr<const sessions::Session> session;
        mapping::MapConfig settings;
        Revision revision;             // of the newest maps used
        std::vector<grid::Cell> cells; // FRONTIER cells that could not be observed, the oldest first
        Looks looks;                   // how often robots looked at cells around their targets
    };

    void remove_expired(Clock::time_point now);

    [[nodiscard]] const Entry* find_entry(const std::shared_ptr<const sessions::Session>& session,
                                          RobotIndex robot) const;
    [[nodiscard]] std::vector<grid::Cell> targets_of_others(const std::shared_ptr<const sessions::Session>& session,
                                                            RobotIndex robot, double cell_size) const;
    void forget_entry(const std::shared_ptr<const sessions::Session>& session, RobotIndex robot);
    [[nodiscard]] Unobserved take_unobserved(const std::shared_ptr<const sessions::Session>& session,
                                             const mapping::Snapshot& maps);
    void keep(Unobserved unobserved);
    static void count_look(const std::vector<grid::Cell>& around_target, Unobserved& unobserved);
    [[nodiscard]] static std::vector<grid::Cell> looked_at_often(const Unobserved& unobserved);

    RobotPaths paths_;
    std::mutex mutex_;
    std::vector<Entry> entries_;         // at most one for each robot
    std::vector<Unobserved> unobserved_; // at most one for each session and settings; the most recently used last
};

} // namespace scanloom::guidance
