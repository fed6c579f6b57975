#include "core/scan_matching/agreement.hpp"

#include "core/scan_matching/line_matching.hpp"

#include <algorithm>
#include <cstddef>

namespace scanloom::scan_matching {
namespace {

constexpr float kMatchReach = 0.2F;    // metres: a point farther from the map than this does not match
constexpr double kScale = 0.06;        // metres: distance from a line at which a point counts half
constexpr double kOutlierWeight = 1.5; // inliers that one outlier outweighs
constexpr double kKnownMin = 0.5;      // of the points, that the score is divided by

} // namespace

Agreement agreement_of(const ScanPoints& scan, const PointMap& map, const SeenSpace& space,
                       const Transform2& T_map_robot) {
    if (scan.points.empty()) return {};
    const Point2 laser = T_map_robot * scan.laser;
    std::size_t matched = 0;
    std::size_t contradicted = 0;
    std::size_t unknown = 0;
    double weights = 0.0;
    for (const SurfacePoint& point : scan.points) {
        const SurfacePoint moved = transform(T_map_robot, point);
        const auto near = map.nearest(moved, kMatchReach);
        if (near.point != nullptr) {
            double squared = near.squared_distance;
            if (near.point->has_normal()) {
                const double residual = double{near.point->normal_x} * (near.point->x - moved.x) +
                                        double{near.point->normal_y} * (near.point->y - moved.y);
                squared = residual * residual;
            }
            weights += kScale * kScale / (kScale * kScale + squared);
        }
        if (near.point != nullptr && near.squared_distance < kInlierDistance * kInlierDistance) {
            ++matched;
        } else if (space.is_free(moved.x, moved.y)) {
            ++contradicted;
        } else if (near.point == nullptr && !space.meets_point(laser, {moved.x, moved.y})) {
            ++unknown;
        }
    }
    const auto count = static_cast<double>(scan.points.size());
    const double known = std::max(count - static_cast<double>(unknown), kKnownMin * count);
    return {static_cast<double>(matched) / count, static_cast<double>(contradicted) / count,
            (weights - kOutlierWeight * static_cast<double>(contradicted)) / known};
}

} // namespace scanloom::scan_matching
