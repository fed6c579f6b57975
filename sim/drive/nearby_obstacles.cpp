#include "sim/drive/nearby_obstacles.hpp"

#include "common/geometry/pose2.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace scanloom::sim {
namespace {

constexpr double kNear = 1.0;    // metres
constexpr double kSquare = 0.05; // metres
constexpr int kRememberedSteps = 60;

} // namespace

void NearObstacles::see(const Senses& senses) {
    const Point2 position{senses.pose.x, senses.pose.y};
    step_ += 1;
    for (const Point2& place : senses.obstacles) {
        if (norm(place - position) > kNear) continue;
        const std::pair square{std::llround(place.x / kSquare), std::llround(place.y / kSquare)};
        seen_.insert_or_assign(square, Seen{place, step_});
    }
    std::erase_if(seen_, [&](const auto& one) {
        const Seen& seen = one.second;
        return seen.step <= step_ - kRememberedSteps || norm(seen.place - position) > kNear;
    });
}

std::vector<Point2> NearObstacles::places() const {
    std::vector<Point2> places;
    places.reserve(seen_.size());
    for (const auto& [square, seen] : seen_) places.push_back(seen.place);
    return places;
}

SectorRanges sector_ranges(const Scan& scan, const Sensor& sensor) {
    constexpr double kSectorBorder = std::numbers::pi / 6.0;
    constexpr double kSectorEnd = std::numbers::pi / 2.0 + 1e-9; // the outermost beam belongs to its sector
    const BeamAngles angles = angles_of(scan, sensor);
    SectorRanges nearest;
    for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
        const RangeMm mm = scan.ranges[i];
        if (mm == kInvalidRange || mm == kNoReturn) continue;
        const double angle = normalize_angle(beam_angle(angles, i));
        if (angle < -kSectorEnd || angle > kSectorEnd) continue;
        double& sector = angle < -kSectorBorder ? nearest.right : angle > kSectorBorder ? nearest.left : nearest.front;
        sector = std::min(sector, static_cast<double>(mm) / 1000.0);
    }
    return nearest;
}

std::vector<Point2> obstacles_of(const Scan& scan, const Sensor& sensor) {
    const BeamAngles angles = angles_of(scan, sensor);
    const Pose2 T_map_sensor = compose(*scan.pose, sensor.mount);
    std::vector<Point2> obstacles;
    obstacles.reserve(scan.ranges.size());
    for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
        const RangeMm mm = scan.ranges[i];
        if (mm == kInvalidRange || mm == kNoReturn) continue;
        const double range = static_cast<double>(mm) / 1000.0;
        const double yaw = T_map_sensor.yaw + beam_angle(angles, i);
        obstacles.push_back({T_map_sensor.x + range * std::cos(yaw), T_map_sensor.y + range * std::sin(yaw)});
    }
    return obstacles;
}

namespace {

constexpr double kTouching = kBodyRadius + 0.005; // metres
constexpr double kSecondsAhead = 0.4;             // a scan is a tenth of a second old when the next one arrives

} // namespace

double free_ahead(const Senses& senses, double yaw) {
    constexpr double kNothing = std::numeric_limits<double>::infinity();
    std::array<double, 3> nearest{kNothing, kNothing, kNothing}; // ascending
    const Point2 ahead{std::cos(yaw), std::sin(yaw)};
    for (const Point2& obstacle : senses.obstacles) {
        const Point2 offset = obstacle - Point2{senses.pose.x, senses.pose.y};
        const double forward = dot(offset, ahead);
        if (forward <= 0.0) continue;
        const double radius = norm(offset) < kKeptClear ? kTouching : kKeptClear;
        const double aside = offset.x * ahead.y - offset.y * ahead.x;
        if (std::abs(aside) >= radius) continue;
        const double free = std::max(0.0, forward - std::sqrt(radius * radius - aside * aside));
        if (free >= nearest.back()) continue;
        nearest.back() = free;
        std::ranges::sort(nearest);
    }
    return nearest.back();
}

double safe_speed(const Senses& senses, double yaw) {
    return std::min(kForwardMax, free_ahead(senses, yaw) / kSecondsAhead);
}

} // namespace scanloom::sim
