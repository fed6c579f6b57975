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

/// Who pursues which frontier: gives each robot of a session its next goal, and no two of them the same frontier.
///
/// A robot's goal counts until the robot asks again, and as long as the WayBook says that the robot holds it: no longer
/// once the robot has left; a robot that comes back asks again. Nothing of it survives a restart.
/// Goals are kept as places in the map frame: those of maps woven with other cells count, too.
///
/// It also remembers what robots have looked at in vain, so that exploring comes to an end where a frontier cannot be
/// seen (glass, a crack, what is too low for the laser). When a robot that has_looked() asks again, the cells that
/// planning::seen_in_vain() counts for nobody's goals any more, as long as they are FRONTIER: each visit changes the
/// map or takes a cell out. A robot that has not looked yet gets the same goal, or a better one. Maps may also go to
/// and fro: beams along a wall free what beams towards it have shown, and show it again, wherever the robot is not. So
/// cells around targets count no more either whenever they are FRONTIER again after kLooksMax looks. This is kept for
/// each session and the settings of the maps, at most kInVainCellsMax cells each: then the oldest go, and looks are
/// counted anew.
///
/// Thread  any; one search at a time.
class GoalBook {
public:
    using Clock = WayBook::Clock;

    static constexpr std::size_t kInVainCellsMax = std::size_t{1} << 16;
    static constexpr int kLooksMax = 2;
    static constexpr std::size_t kSettingsMax = 8; ///< of one session; the least recently asked for go

    /// The next goal of a robot at `position`, kept for it from now on.
    /// @param maps  the session's, or others woven from its log
    /// Errors  as planning::next_goal(); the robot has no goal then.
    [[nodiscard]] Result<planning::NextGoal> next(const std::shared_ptr<const session::Session>& session,
                                                  const mapping::Snapshot& maps, RobotIndex robot,
                                                  const Point2& position, Clock::time_point now,
                                                  const planning::ExplorationOptions& options = {});

    /// What robots were told, these goals among it.
    [[nodiscard]] WayBook& ways() noexcept { return ways_; }

private:
    struct Entry {
        std::weak_ptr<const session::Session> session;
        RobotIndex robot;
        std::uint64_t given;         // WayBook::give_goal()
        mapping::MapConfig settings; // of the maps
        grid::Cell goal;
        std::vector<grid::Cell> around_target;
        Visit visit;
    };

    using Looks = std::map<std::pair<std::int32_t, std::int32_t>, int>; // by (j, i)

    struct InVain {
        std::weak_ptr<const session::Session> session;
        mapping::MapConfig settings;
        Revision revision;             // of the newest maps asked on
        std::vector<grid::Cell> cells; // FRONTIER, looked at in vain, the oldest first
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
    std::vector<Entry> entries_;  // at most one a robot
    std::vector<InVain> in_vain_; // of each session and settings one, if it has any; the last asked for last
};

} // namespace scanloom::guide
