#pragma once

#include "core/mapping/projection.hpp"
#include "sim/range_sensors.hpp"
#include "sim/world.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace scanloom::testing_support {

/// A robot in a simulated world that drives to given targets and scans at each step.
class ExploringRobot {
public:
    static constexpr double kStep = 0.25; // metres

    ExploringRobot(RobotIndex index, const sim::World& world, Sensor laser, const Pose2& start,
                   const std::optional<sim::Noise>& noise)
        : index_(index), world_(&world), laser_(std::move(laser)), noise_(noise), random_(index + 1), pose_(start) {}

    void join(mapping::Projection& maps) {
        maps.apply(RobotJoined{index_, "r" + std::to_string(index_)}).value();
        maps.apply(SensorDescribed{index_, laser_}).value();
        scan(maps);
    }

    /// Follows the path, then turns towards the target.
    void go(std::vector<Point2> path, const Point2& target) {
        way_ = std::move(path);
        passed_ = 0;
        target_ = target;
    }

    [[nodiscard]] bool has_arrived() const { return !target_; }
    [[nodiscard]] const Pose2& pose() const { return pose_; }
    [[nodiscard]] Point2 place() const { return {pose_.x, pose_.y}; }
    [[nodiscard]] double least_clearance() const { return least_clearance_; }

    /// Pre  the robot has not arrived.
    void step(mapping::Projection& maps) {
        if (!advance(kStep)) {
            if (norm(*target_ - place()) > 0.0) pose_.yaw = direction(*target_ - place());
            target_.reset();
        }
        least_clearance_ = std::min(least_clearance_, sim::clearance(*world_, place()));
        scan(maps);
    }

private:
    static double direction(const Point2& along) { return std::atan2(along.y, along.x); }

    /// @return whether the robot was not yet at the end of its path
    bool advance(double metres) {
        bool moved = false;
        while (metres > 0.0 && passed_ + 1 < way_.size()) {
            const Point2 left = way_[passed_ + 1] - place();
            const double length = norm(left);
            if (length > 0.0) {
                pose_.yaw = direction(left);
                moved = true;
            }
            if (length <= metres) {
                pose_.x = way_[passed_ + 1].x;
                pose_.y = way_[passed_ + 1].y;
                ++passed_;
            } else {
                pose_.x += metres / length * left.x;
                pose_.y += metres / length * left.y;
            }
            metres -= length;
        }
        return moved;
    }

    void scan(mapping::Projection& maps) {
        Scan scan;
        scan.seq = ++seq_;
        scan.stamp = 0.5 * static_cast<double>(seq_);
        scan.sensor = laser_.id;
        scan.pose = pose_;
        scan.ranges = sim::sweep(*world_, laser_, pose_, noise_, random_);
        maps.apply(ScanTaken{index_, std::move(scan)}).value();
    }

    RobotIndex index_;
    const sim::World* world_;
    Sensor laser_;
    std::optional<sim::Noise> noise_;
    sim::Random random_;
    Pose2 pose_;
    std::uint64_t seq_ = 0;
    std::vector<Point2> way_;
    std::size_t passed_ = 0;
    std::optional<Point2> target_; // of the current path
    double least_clearance_ = HUGE_VAL;
};

} // namespace scanloom::testing_support
