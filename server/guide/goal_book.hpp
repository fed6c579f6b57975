#pragma once

#include "server/guide/visit.hpp"
#include "server/guide/way_book.hpp"
#include "server/mapping/snapshot.hpp"
#include "server/planning/goals.hpp"
#include "server/session/session.hpp"

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace scanloom::guide {

/// Assigns each robot of a session its next goal, and no two robots the same frontier.
///
/// A robot's goal counts until the robot asks for the next one, and only while the WayBook says that the robot holds
/// it. So it no longer counts after the robot has left; a robot that returns asks again. Goals do not survive a
/// restart. They are stored as positions in the map frame, so goals found in maps with another cell size count as well.
///
/// The book also remembers frontiers that robots could not observe, so that exploration ends where a frontier cannot be
/// seen (glass, a narrow gap, things too low for the laser). When a robot that has_looked() asks again, the cells that
/// planning::seen_in_vain() returns are excluded from the goals of all robots, as long as they are FRONTIER: each visit
/// changes the map or excludes a cell. A robot that has not looked yet gets the same goal or a better one.
///
/// Maps may also alternate in places away from the robot: beams along a wall clear what beams towards the wall have
/// shown, and those show it again. So cells around targets are also excluded whenever they are FRONTIER again after
/// kLooksMax looks. Excluded cells and looks are kept for each session and the settings of its maps, at most
/// kInVainCellsMax cells each. Beyond that, the oldest cells are dropped and looks are counted from 0 again.
///
/// Threads: any thread; one search at a time.
class GoalBook {
public:
    using Clock = WayBook::Clock;

    static constexpr std::size_t kInVainCellsMax = std::size_t{1} << 16;
    static constexpr int kLooksMax = 2;
    static constexpr std::size_t kSettingsMax = 8; ///< of one session; the least recently used are dropped

    /// Finds the next goal of a robot and keeps it for that robot.
    /// @param maps      the session's maps, or the maps of a replay job of its log
    /// @param position  of the robot, metres, map frame
    /// @return the goal, or why there is none
    /// Errors: those of planning::next_goal(); the robot has no goal then.
    [[nodiscard]] Result<planning::NextGoal> next(const std::shared_ptr<const session::Session>& session,
                                                  const mapping::Snapshot& maps, RobotIndex robot,
                                                  const Point2& position, Clock::time_point now,
                                                  const planning::ExplorationOptions& options = {});

    /// Returns the goals and paths that robots hold, which include the goals assigned here.
    [[nodiscard]] WayBook& ways() noexcept { return ways_; }

private:
    struct Entry {
        std::weak_ptr<const session::Session> session;
        RobotIndex robot;
        std::uint64_t given;         // result of WayBook::give_goal()
        mapping::MapConfig settings; // settings of the maps
        grid::Cell goal;
        std::vector<grid::Cell> around_target;
        Visit visit;
    };

    using Looks = std::map<std::pair<std::int32_t, std::int32_t>, int>; // number of looks by (j, i)

    struct InVain {
        std::weak_ptr<const session::Session> session;
        mapping::MapConfig settings;
        Revision revision;             // of the newest maps used
        std::vector<grid::Cell> cells; // FRONTIER cells that could not be observed, the oldest first
        Looks looks;                   // how often robots looked at cells around their targets
    };

    void forget_what_counts_no_longer(Clock::time_point now);

    [[nodiscard]] const Entry* find_entry(const std::shared_ptr<const session::Session>& session,
                                          RobotIndex robot) const;
    [[nodiscard]] std::vector<grid::Cell> targets_of_others(const std::shared_ptr<const session::Session>& session,
                                                            RobotIndex robot, double cell_size) const;
    void forget_entry(const std::shared_ptr<const session::Session>& session, RobotIndex robot);
    [[nodiscard]] InVain take_in_vain(const std::shared_ptr<const session::Session>& session,
                                      const mapping::Snapshot& maps);
    void keep(InVain in_vain);
    static void count_look(const std::vector<grid::Cell>& around_target, InVain& in_vain);
    [[nodiscard]] static std::vector<grid::Cell> looked_at_often(const InVain& in_vain);

    WayBook ways_;
    std::mutex mutex_;
    std::vector<Entry> entries_;  // at most one for each robot
    std::vector<InVain> in_vain_; // at most one for each session and settings; the most recently used last
};

} // namespace scanloom::guide
