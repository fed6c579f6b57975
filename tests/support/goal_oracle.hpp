#pragma once

#include "core/mapping/projection.hpp"
#include "server/guidance/goal_assignments.hpp"
#include "sim/drive/explore.hpp"
#include "sim/robot/exploring_source.hpp"

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
        : session_(std::move(session)), maps_(config) {
        options_.passability.body_radius_m = sim::Explore::kPathClearance;
    }

    void join(RobotIndex robot, const Sensor& laser) {
        maps_.apply(RobotJoined{robot, "r" + std::to_string(robot)}).value();
        maps_.apply(SensorDescribed{robot, laser}).value();
    }

    void take(RobotIndex robot, Scan scan) { maps_.apply(ScanTaken{robot, std::move(scan)}).value(); }

    [[nodiscard]] Result<robot::NextStop> next(RobotIndex robot) {
        const auto maps = maps_.snapshot();
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

    [[nodiscard]] mapping::Snapshot maps() { return maps_.snapshot(); }
    [[nodiscard]] int asked() const noexcept { return asked_; }
    /// Returns (j, i) of the cells around the targets that robots drove to and after which they requested another goal.
    [[nodiscard]] const std::set<std::pair<std::int32_t, std::int32_t>>& looked_at() const noexcept {
        return looked_at_;
    }

private:
    std::shared_ptr<const sessions::Session> session_;
    mapping::Projection maps_;
    guidance::GoalAssignments book_;
    planning::ExplorationOptions options_;
    int asked_ = 0;
    std::map<RobotIndex, std::vector<grid::Cell>> around_target_; // of the goals that robots drive to
    std::set<std::pair<std::int32_t, std::int32_t>> looked_at_;
};

} // namespace scanloom::testing_support
