#include "lab/trajectory_variants.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scanloom::lab {
namespace {

/// Returns a twentieth of a number, rounded up to one digit; at least 1.
std::size_t rounded_twentieth(std::size_t number) {
    const double part = std::max(1.0, static_cast<double>(number) / 20.0);
    double unit = 1.0;
    while (part >= 10.0 * unit) unit *= 10.0;
    return static_cast<std::size_t>(std::ceil(part / unit) * unit);
}

} // namespace

std::vector<Variant> variants_of(std::size_t scans) {
    const std::size_t late = rounded_twentieth(scans);
    std::vector<Variant> variants;
    for (const double scale : {0.97, 0.98, 0.99, 1.01, 1.02, 1.03}) {
        for (const std::size_t skip : {std::size_t{0}, late, 3 * late}) {
            variants.push_back({Poses::kOdometry, {.odometry_scale = scale, .skip = skip}});
        }
        variants.push_back({Poses::kOdometry, {.odometry_scale = scale, .every = 2}});
    }
    for (const std::size_t halves : {1U, 2U, 3U, 4U, 5U, 6U}) {
        variants.push_back({Poses::kNone, {.skip = std::max<std::size_t>(1, halves * late / 2)}});
    }
    return variants;
}

std::string text_of(const Variant& variant) {
    const auto& [scale, skip, every] = variant.perturbation;
    std::string text = "odometry unchanged";
    if (variant.poses == Poses::kNone) {
        text = "no odometry";
    } else if (scale != 1.0) {
        text = fmt::format("odometry x {}", scale);
    }
    if (skip > 0) text += fmt::format(", without the first {} scans", skip);
    if (every > 1) text += fmt::format(", one scan of {}", every);
    return text;
}

std::vector<robot::StampedPose> part_of(const std::vector<robot::StampedPose>& whole,
                                        const Perturbation& perturbation) {
    std::vector<robot::StampedPose> part;
    for (std::size_t n = perturbation.skip; n < whole.size(); n += perturbation.every) part.push_back(whole[n]);
    return part;
}

TrajectoryDistance distance_between(const std::vector<robot::StampedPose>& reference,
                                    const std::vector<robot::StampedPose>& poses) {
    const auto position = [](const Pose2& pose) { return Point2{pose.x, pose.y}; };
    const auto count = static_cast<double>(poses.size());
    Point2 center{0.0, 0.0};
    Point2 reference_center{0.0, 0.0};
    for (std::size_t n = 0; n < poses.size(); ++n) {
        center += position(poses[n].robot) / count;
        reference_center += position(reference[n].robot) / count;
    }
    double cross = 0.0;
    double dot = 0.0;
    for (std::size_t n = 0; n < poses.size(); ++n) {
        const Point2 a = position(poses[n].robot) - center;
        const Point2 b = position(reference[n].robot) - reference_center;
        cross += a.x * b.y - a.y * b.x;
        dot += a.x * b.x + a.y * b.y;
    }
    const Pose2 turn{0.0, 0.0, std::atan2(cross, dot)};
    TrajectoryDistance distance;
    for (std::size_t n = 0; n < poses.size(); ++n) {
        const Pose2& pose = poses[n].robot;
        const Pose2& expected = reference[n].robot;
        const Point2 moved = transform(turn, position(pose) - center) + reference_center;
        const double yaw_error = normalize_angle(pose.yaw + turn.yaw - expected.yaw);
        const double degrees = std::fabs(yaw_error) * 180.0 / std::numbers::pi;
        distance.metres = std::max(distance.metres, std::hypot(moved.x - expected.x, moved.y - expected.y));
        distance.degrees = std::max(distance.degrees, degrees);
        if (degrees > kTurned) ++distance.turned_scans;
    }
    return distance;
}

} // namespace scanloom::lab
