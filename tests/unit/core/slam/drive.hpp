#pragma once

#include "core/slam/trajectory_estimator.hpp"
#include "tests/support/building.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <utility>
#include <vector>

namespace scanloom::slam {

/// What a robot measures on its way: scans and odometry, with the true poses.
struct Drive {
    Sensor laser = testing_support::Building::laser();
    std::vector<Pose2> truth;    ///< T_map_robot; the first one is where the map begins
    std::vector<Pose2> odometry; ///< T_odom_robot
    std::vector<Scan> scans;
};

/// Errors of the odometry of a drive.
struct OdometryErrors {
    double scale = 1.0; ///< of ways
    double turn = 0.0;  ///< radians for each metre
};

/// Moves through points on straight lines with turns on the spot, 10 cm and 0.1 rad between scans, and takes a scan at
/// each pose.
inline Drive drive_along(const testing_support::Building& building, std::span<const Point2> points,
                         const OdometryErrors& errors, std::uint32_t seed,
                         Sensor laser = testing_support::Building::laser()) {
    Drive drive;
    drive.laser = std::move(laser);
    const auto to = [&](const Point2& from, const Point2& target) {
        return std::atan2(target.y - from.y, target.x - from.x);
    };
    Pose2 pose{points[0].x, points[0].y, to(points[0], points[1])};
    drive.truth.push_back(pose);
    for (std::size_t n = 1; n < points.size(); ++n) {
        const double turn = normalize_angle(to({pose.x, pose.y}, points[n]) - pose.yaw);
        const auto turns = static_cast<int>(std::ceil(std::fabs(turn) / 0.1));
        for (int step = 1; step <= turns; ++step) {
            drive.truth.push_back({pose.x, pose.y, normalize_angle(pose.yaw + turn * step / turns)});
        }
        const Point2 from{pose.x, pose.y};
        const double length = std::hypot(points[n].x - from.x, points[n].y - from.y);
        const auto steps = static_cast<int>(std::ceil(length / 0.1));
        pose.yaw = normalize_angle(pose.yaw + turn);
        for (int step = 1; step <= steps; ++step) {
            const double part = static_cast<double>(step) / steps;
            drive.truth.push_back(
                {from.x + part * (points[n].x - from.x), from.y + part * (points[n].y - from.y), pose.yaw});
        }
        pose = drive.truth.back();
    }
    std::mt19937 random(seed);
    Pose2 odometry;
    for (std::size_t n = 0; n < drive.truth.size(); ++n) {
        if (n > 0) {
            Pose2 motion = compose(inverse(drive.truth[n - 1]), drive.truth[n]);
            motion.yaw += errors.turn * std::fabs(motion.x);
            odometry = compose(odometry, {errors.scale * motion.x, errors.scale * motion.y, motion.yaw});
        }
        drive.odometry.push_back(odometry);
        drive.scans.push_back(building.scan(drive.laser, drive.truth[n], 0.01, random));
    }
    return drive;
}

/// The estimator of a robot that is alone in its map.
struct LoneEstimator {
    std::unique_ptr<SharedMap> map = std::make_unique<SharedMap>();
    TrajectoryEstimator estimator{*map};

    void finish() {
        estimator.finish();
        map->finish();
    }
    TrajectoryEstimator* operator->() noexcept { return &estimator; }
    const TrajectoryEstimator* operator->() const noexcept { return &estimator; }
};

/// Returns a drive's estimator after all its scans.
inline LoneEstimator estimated(const Drive& drive, bool with_odometry) {
    LoneEstimator estimator;
    for (std::size_t n = 0; n < drive.scans.size(); ++n) {
        estimator->add(scan_matching::points_of(drive.scans[n], drive.laser),
                       with_odometry ? std::optional(drive.odometry[n]) : std::nullopt);
    }
    estimator.finish();
    return estimator;
}

/// Adds a keyframe of the only fragment, which the first one begins. Its pose is relative to the newest keyframe.
inline void add(KeyframeGraph& graph, std::shared_ptr<const ScanPoints> scan, const Transform2& T_newest_keyframe) {
    if (graph.size() == 0) {
        graph.begin_fragment(0, std::move(scan), T_newest_keyframe, true);
    } else {
        graph.add(0, std::move(scan), T_newest_keyframe);
    }
}

/// Returns the largest distance of estimated poses from the true ones, in metres, when the first poses are equal.
inline double largest_error(const Drive& drive, const std::function<Pose2(std::size_t)>& pose_of) {
    const Pose2 T_truth_map = compose(drive.truth.front(), inverse(pose_of(0)));
    double largest = 0.0;
    for (std::size_t n = 0; n < drive.truth.size(); ++n) {
        const Pose2 pose = compose(T_truth_map, pose_of(n));
        largest = std::max(largest, std::hypot(pose.x - drive.truth[n].x, pose.y - drive.truth[n].y));
    }
    return largest;
}

/// Returns a corridor 2 m wide around a closed block: 34 x 22 m outside. Posts at uneven distances on the outer walls
/// make places distinguishable.
inline testing_support::Building ring_building() {
    testing_support::Building building;
    building.add_box(0.0, 0.0, 34.0, 22.0);
    building.add_box(2.0, 2.0, 32.0, 20.0);
    double at = 1.7;
    for (int n = 0; at < 30.0; ++n) {
        const double size = 0.3 + 0.1 * (n % 4);
        building.add_box(at, 0.0, at + size, size);
        building.add_box(at + 0.9, 22.0 - size, at + 0.9 + size, 22.0);
        if (at < 19.0) building.add_box(0.0, at + 0.6, size, at + 0.6 + size);
        if (at < 19.0) building.add_box(34.0 - size, at, 34.0, at + size);
        at += 1.3 + 0.37 * ((n * 7) % 5);
    }
    return building;
}

/// A lap of ring_building() and a quarter of the next one.
inline const std::vector<Point2> kLapAndAQuarter{{10.0, 1.0}, {33.0, 1.0}, {33.0, 21.0},
                                                 {1.0, 21.0}, {1.0, 1.0},  {30.0, 1.0}};

} // namespace scanloom::slam
