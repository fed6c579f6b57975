#include "core/slam/trajectory_estimator.hpp"
#include "sim/drive/waypoints.hpp"
#include "sim/simulator.hpp"
#include "sim/world.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// A person walks through the office with a lidar in the hand, which knows nothing of its poses.
namespace scanloom::slam {
namespace {

/// The scans of two minutes, with the true poses.
struct Walk {
    Sensor laser = *sim::find_laser("handheld");
    std::vector<Scan> scans;
};

Walk walk_through_office(const std::optional<sim::Noise>& noise, std::uint64_t seed) {
    Walk walk;
    sim::SimulatorOptions options{*sim::find_world("office"), walk.laser, noise, seed};
    options.is_carried = true;
    sim::Simulator simulator(std::move(options),
                             std::make_unique<sim::Waypoints>(sim::tour_of("office"), sim::TourStart::kNearest,
                                                              [](const Point2&) { return std::string(); }));
    while (walk.scans.size() < 1200) walk.scans.push_back(simulator.next_scan());
    return walk;
}

/// Distances of the final poses from the true ones, in metres, when the first poses are equal.
struct PoseErrors {
    double largest = 0.0;
    double mean = 0.0;
};

PoseErrors errors_of(const Walk& walk, bool with_times) {
    SharedMap map;
    TrajectoryEstimator estimator(map);
    for (Scan scan : walk.scans) {
        scan.pose.reset();
        scan.odometry.reset();
        if (!with_times) scan.duration = 0.0;
        estimator.add(scan, walk.laser);
    }
    estimator.finish();
    map.finish();
    const Pose2 T_truth_map = compose(*walk.scans[0].pose, inverse(estimator.pose_of(0)));
    PoseErrors errors;
    for (std::size_t n = 0; n < walk.scans.size(); ++n) {
        const Pose2 off = compose(inverse(*walk.scans[n].pose), compose(T_truth_map, estimator.pose_of(n)));
        const double error = std::hypot(off.x, off.y);
        errors.largest = std::max(errors.largest, error);
        errors.mean += error / static_cast<double>(walk.scans.size());
    }
    return errors;
}

void expect_exact_poses(std::optional<sim::Noise> noise, std::uint64_t seed) {
    const Walk walk = walk_through_office(noise, seed);
    const PoseErrors with = errors_of(walk, true);
    const PoseErrors without = errors_of(walk, false);
    for (const auto& [name, errors] : {std::pair("with_times", with), std::pair("without_times", without)}) {
        const std::string property = name;
        testing::Test::RecordProperty(property + "_largest_mm", static_cast<int>(std::lround(1000.0 * errors.largest)));
        testing::Test::RecordProperty(property + "_mean_mm", static_cast<int>(std::lround(1000.0 * errors.mean)));
    }
    EXPECT_LT(with.largest, 0.25);
    EXPECT_LT(with.mean, 0.05);
    EXPECT_GT(without.largest, 3.0 * with.largest);
    EXPECT_GT(without.mean, 6.0 * with.mean);
}

TEST(CarriedLidar, PosesOfAWalkAreExactIfTheBeamsHaveTimes) { expect_exact_poses(sim::Noise{}, 2); }

TEST(CarriedLidarTrials, PosesOfAWalkAreExactWithoutNoise) { expect_exact_poses(std::nullopt, 1); }

} // namespace
} // namespace scanloom::slam
