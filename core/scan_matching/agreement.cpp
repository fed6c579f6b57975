#include "core/scan_matching/agreement.hpp"

#include "core/scan_matching/line_matching.hpp"

#include <cstddef>

namespace scanloom::scan_matching {
namespace {

constexpr float kMatchReach = 0.2F;    // metres: a point farther from the map than this does not match
constexpr double kScale = 0.06;        // metres: distance from a line at which a point counts half
constexpr double kOutlierWeight = 1.5; // inliers that one outlier outweighs

} // namespace

Agreement agreement_of(std::span<const SurfacePoint> points, const PointMap& map, const SeenSpace& space,
                       const Transform2& T_map_robot) {
    if (points.empty()) return {};
    std::size_t matched = 0;
    std::size_t contradicted = 0;
    double weights = 0.0;
    for (const SurfacePoint& point : points) {
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
        }
    }
    const auto count = static_cast<double>(points.size());
    return {static_cast<double>(matched) / count, static_cast<double>(contradicted) / count,
            (weights - kOutlierWeight * static_cast<double>(contradicted)) / count};
}

} // namespace scanloom::scan_matching
