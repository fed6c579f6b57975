#include "core/landmarks/alignment_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace scanloom::landmarks {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kSameSurface = 0.15;      // metres between elements of one surface
constexpr double kSameLine = 0.07;         // metres from a straight element's line
constexpr double kSameSurfaceCosine = 0.8; // cosine between the normals of one surface
constexpr double kDepth = 0.2;             // metres by which a place must be nearer or further to be in front or behind

bool is_matched(const Surface& surface, const Surfel& there, const Point2& place, const Pose2& rotation) {
    const auto near = surface.nearest_within(place, kSameSurface);
    if (!near) return false;
    const Surfel& here = surface.surfels()[near->index];
    if (!here.is_straight()) return true;
    if (std::abs(dot(here.normal, place - here.position)) > kSameLine) return false;
    return !there.is_straight() || std::abs(dot(here.normal, transform(rotation, there.normal))) >= kSameSurfaceCosine;
}

/// Returns whether any of the horizons looked through a place.
bool is_open(std::span<const Horizon* const> horizons, const Point2& place) {
    return std::ranges::any_of(horizons, [&](const Horizon* horizon) {
        return horizon->reaches(place) && horizon->at(place) == Horizon::Verdict::kOpen;
    });
}

} // namespace

Horizon::Horizon(std::span<const Point2> points, const Point2& from) : from_(from) {
    reaches_.fill({kInfinite, 0.0});
    for (const Point2& point : points) {
        Reach& reach = reaches_[sector_of(point - from)];
        const double range = norm(point - from);
        reach = {std::min(reach.nearest, range), std::max(reach.furthest, range)};
        reach_ = std::max(reach_, range);
    }
}

std::size_t Horizon::sector_of(const Point2& offset) {
    const double turns = std::atan2(offset.y, offset.x) / (2.0 * std::numbers::pi) + 0.5;
    return static_cast<std::size_t>(turns * static_cast<double>(kSectors)) % kSectors;
}

Horizon::Verdict Horizon::at(const Point2& place) const {
    const Point2 offset = place - from_;
    const std::size_t sector = sector_of(offset);
    Reach around{kInfinite, 0.0};
    for (const std::size_t side : {kSectors - 1, std::size_t{0}, std::size_t{1}}) {
        const Reach& reach = reaches_[(sector + side) % kSectors];
        around = {std::min(around.nearest, reach.nearest), std::max(around.furthest, reach.furthest)};
    }
    if (around.nearest > around.furthest) return Verdict::kUnknown;
    const double range = norm(offset);
    if (range < around.nearest - kDepth) return Verdict::kOpen;
    return range > around.furthest + kDepth ? Verdict::kHidden : Verdict::kUnknown;
}

Evidence evidence_of(const Surface& surface, std::span<const Horizon* const> horizons, std::span<const Surfel> second,
                     const Pose2& T_first_second) {
    Evidence evidence{.elements = second.size()};
    const Pose2 rotation{0.0, 0.0, T_first_second.yaw};
    for (const Surfel& there : second) {
        const Point2 place = transform(T_first_second, there.position);
        if (is_matched(surface, there, place, rotation)) {
            ++evidence.inliers;
        } else if (is_open(horizons, place)) {
            ++evidence.outliers;
        }
    }
    return evidence;
}

} // namespace scanloom::landmarks
