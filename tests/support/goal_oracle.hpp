#pragma once

#include "core/localization/localized_projection.hpp"
#include "core/mapping/projection.hpp"
#include "server/guidance/goal_assignments.hpp"
#include "sim/drive/explore.hpp"
#include "sim/robot/exploring_source.hpp"

#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::testing_support {

/// Computes a server's answers to the robots of one session, without a server.
class GoalOracle {
public:
    explicit GoalOracle(std::shared_ptr<const sessions::Session> session, const mapping::MapConfig& config = {})
        : session_(std::move(session)), maps_(mapping::Projection(config)) {
        options_.passability.body_radius_m = sim::Explore::kPathClearance;
    }

    void join(RobotIndex robot, const Sensor& laser, Poses poses = Poses::kMap) {
        has_estimated_poses_ = has_estimated_poses_ || poses != Poses::kMap;
        apply(RobotJoined{robot, "r" + std::to_string(robot), {}, {}, poses});
        apply(SensorDescribed{robot, laser});
    }

    void take(RobotIndex robot, Scan scan) { apply(ScanTaken{robot, std::move(scan)}); }

    /// Returns T_map_odom by the robot's newest scan. Pre: its poses are odometry, and it has a scan.
    [[nodiscard]] const Pose2& T_map_odom(RobotIndex robot) const {
        return maps_.poses().find(robot)->location().T_map_odom;
    }

    [[nodiscard]] Result<robot::NextStop> next(RobotIndex robot) {
        const auto maps = this->maps();
        for (const grid::Cell cell : around_target_[robot]) looked_at_.insert({cell.j, cell.i}); // a new request
        around_target_[robot].clear();
        const Pose2 pose = *maps.robots.at(robot).pose;
        auto found = book_.next(session_, maps, robot, {pose.x, pose.y}, {}, options_);
        asked_ += 1;
        if (!found) return found.error();
        around_target_[robot] = found->around_target;
        robot::NextStop stop;
        if (found->outcome == planning::Exploration::kTakenByOthers) {
            stop.outcome = robot::NextStop::Outcome::kTakenByOthers;
        } else if (found->goal) {
            stop.outcome = robot::NextStop::Outcome::kGoal;
            stop.path = std::move(found->path.points);
            stop.target = Point2{found->goal->target.i + 0.5, found->goal->target.j + 0.5} * maps.config.cell_size;
        }
        return stop;
    }

    [[nodiscard]] mapping::Snapshot maps() { return maps_.projection().snapshot(); }
    [[nodiscard]] int asked() const noexcept { return asked_; }
    /// Returns (j, i) of the cells around the targets that robots drove to and after which they requested another goal.
    [[nodiscard]] const std::set<std::pair<std::int32_t, std::int32_t>>& looked_at() const noexcept {
        return looked_at_;
    }

private:
    /// Applies an entry. When poses were corrected, makes the maps again.
    void apply(LogEntry entry) {
        if (has_estimated_poses_) log_.push_back(entry);
        double work = HUGE_VAL;
        maps_.apply(entry, work).value();
        if (!maps_.is_outdated()) return;
        mapping::Projection corrected(maps_.projection().config());
        const auto poses = maps_.poses().in_maps();
        for (LogEntry earlier : log_) {
            poses.place(earlier);
            corrected.apply(earlier).value();
        }
        maps_.replace(std::move(corrected), maps_.poses().corrected());
    }

    std::shared_ptr<const sessions::Session> session_;
    localization::LocalizedProjection maps_;
    std::vector<LogEntry> log_; // empty if all robots send poses
    bool has_estimated_poses_ = false;
    guidance::GoalAssignments book_;
    planning::ExplorationOptions options_;
    int asked_ = 0;
    std::map<RobotIndex, std::vector<grid::Cell>> around_target_; // of the goals that robots drive to
    std::set<std::pair<std::int32_t, std::int32_t>> looked_at_;
};

} // namespace scanloom::testing_support
