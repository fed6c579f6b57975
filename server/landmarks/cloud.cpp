#include "server/landmarks/cloud.hpp"

#include "server/landmarks/point_check.hpp"

#include <fmt/format.h>

#include <cmath>

namespace scanloom::landmarks {

Result<std::vector<Point2>> transform_points(std::span<const Point2> points, const Point2& translation,
                                             double rotation_rad, double scale) {
    if (auto good = check_points(points); !good) return good.error();
    if (!is_finite(translation) || !std::isfinite(rotation_rad)) {
        return Error{Errc::kInvalidField, fmt::format("translation ({:g}, {:g}) m and rotation {:g} rad must be finite",
                                                      translation.x, translation.y, rotation_rad)};
    }
    if (!(scale > 0.0) || !std::isfinite(scale)) {
        return Error{Errc::kInvalidField, fmt::format("scale is {:g}; it must be finite and more than 0", scale)};
    }
    const Pose2 pose{translation.x, translation.y, rotation_rad};
    std::vector<Point2> transformed;
    transformed.reserve(points.size());
    for (const Point2& point : points) transformed.push_back(transform(pose, scale * point));
    if (auto good = check_points(transformed, "transformed"); !good) return good.error();
    return transformed;
}

} // namespace scanloom::landmarks
