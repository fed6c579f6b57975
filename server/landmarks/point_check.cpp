#include "server/landmarks/point_check.hpp"

#include <fmt/format.h>

namespace scanloom::landmarks {

Result<> check_points(std::span<const Point2> points, std::string_view name) {
    if (points.size() > kPointsMax) {
        return Error{Errc::kTooLarge, fmt::format("{} are {}, more than the {} points of one cloud: give fewer", name,
                                                  points.size(), kPointsMax)};
    }
    for (std::size_t n = 0; n < points.size(); ++n) {
        if (!is_finite(points[n])) {
            return Error{Errc::kInvalidField, fmt::format("{}[{}] is not finite: leave it out", name, n)};
        }
        if (max_abs(points[n]) > kPointCoordinateMax) {
            return Error{Errc::kInvalidField,
                         fmt::format("{}[{}] is ({}, {}), further than {} m from the origin: leave it out", name, n,
                                     points[n].x, points[n].y, kPointCoordinateMax)};
        }
    }
    return {};
}

} // namespace scanloom::landmarks
