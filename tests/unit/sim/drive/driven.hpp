#pragma once

#include "sim/drive/behaviour.hpp"
#include "sim/range_sensors.hpp"
#include "sim/simulator.hpp"

#include <functional>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

namespace scanloom::sim {

/// Returns a square room of 6 x 6 m inside, centred at the origin, with furniture.
inline World walled(std::vector<Box> furniture) {
    for (const Box& wall :
         {Box{-3.2, -3.2, 3.2, -3.0}, {-3.2, 3.0, 3.2, 3.2}, {-3.2, -3.2, -3.0, 3.2}, {3.0, -3.2, 3.2, 3.2}}) {
        furniture.push_back(wall);
    }
    return make_world("walled", std::move(furniture), {{-3.0, -3.0, 3.0, 3.0}});
}

/// Runs a behaviour in a world, beginning at a pose.
class Driven {
public:
    Driven(World world, const Pose2& start, std::unique_ptr<Behaviour> behaviour)
        : simulator_({std::move(world), *find_laser("reference"), std::nullopt, 1, start}, std::move(behaviour)) {}

    /// Runs until the behaviour is done or `seconds` have passed.
    /// @return whether the behaviour is done
    bool run(
        double seconds, const std::function<void()>& each_scan = [] {}) {
        for (int n = 0; n < static_cast<int>(seconds / kScanPeriod) && !is_done(); ++n) {
            const Pose2 pose = *simulator_.next_scan().pose;
            trajectory_.push_back({pose.x, pose.y});
            clearance_min_ = std::min(clearance_min_, clearance(simulator_.world(), trajectory_.back()));
            each_scan();
        }
        return is_done();
    }

    [[nodiscard]] bool is_done() const { return !trajectory_.empty() && simulator_.behaviour().is_done(); }
    [[nodiscard]] const Simulator& simulator() const { return simulator_; }
    [[nodiscard]] const std::vector<Point2>& trajectory() const { return trajectory_; }
    [[nodiscard]] double clearance_min() const { return clearance_min_; }

    /// Returns the smallest distance between the trajectory and a point (m).
    [[nodiscard]] double nearest_to(const Point2& point) const {
        double nearest = std::numeric_limits<double>::infinity();
        for (const Point2& place : trajectory_) nearest = std::min(nearest, norm(place - point));
        return nearest;
    }

private:
    Simulator simulator_;
    std::vector<Point2> trajectory_; // one point per scan
    double clearance_min_ = std::numeric_limits<double>::infinity();
};

} // namespace scanloom::sim
