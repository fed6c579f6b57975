#pragma once

#include "common/error/error.hpp"
#include "common/geometry/point2.hpp"
#include "common/geometry/pose2.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace scanloom::landmarks {

/// Converts a point to Eigen's type.
[[nodiscard]] inline Eigen::Vector2d to_eigen(const Point2& point) { return {point.x, point.y}; }
/// Converts a point from Eigen's type.
[[nodiscard]] inline Point2 from_eigen(const Eigen::Vector2d& vector) { return {vector.x(), vector.y()}; }

inline constexpr double kPointCoordinateMax = 1e7;            ///< metres from the origin, each axis
inline constexpr std::size_t kCloudPointsMax = 1'000'000'000; ///< of one cloud

/// Checks that points are usable: squares of their distances and numbers of cells stay far from overflow.
/// @param points  metres
/// @param name    how an error message calls them: "second[3] is not finite"
/// Errors: kInvalidField if a point is not finite or beyond kPointCoordinateMax, with the first such point in the
///     message; kTooLarge if there are more than kCloudPointsMax.
[[nodiscard]] Result<> check_points(std::span<const Point2> points, std::string_view name = "points");

/// Returns the middle value; of an even count, the mean of the middle two. Reorders the values.
/// @param values  reordered
/// Precondition: there is at least one value; all are finite.
[[nodiscard]] inline double median(std::span<double> values) {
    assert(!values.empty());
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    if (values.size() % 2 == 1) return *middle;
    return 0.5 * (*std::max_element(values.begin(), middle) + *middle);
}

/// A cloud's points with equal ones merged: a stationary lidar measures the same points repeatedly. They are in the
/// order of their first occurrence, so of two distinct points the one with the lower number also has the lower index in
/// the cloud.
struct DistinctPoints {
    std::vector<Point2> points;        ///< metres
    std::vector<std::uint32_t> counts; ///< for each distinct point, how many points of the cloud are equal to it
    std::vector<std::uint32_t> of;     ///< for each point of the cloud, the number of its distinct point
};

/// Merges the equal points of a cloud.
/// @param cloud  metres
/// Precondition: the points pass check_points().
/// Cost: O(n log n).
[[nodiscard]] DistinctPoints distinct_points(std::span<const Point2> cloud);

} // namespace scanloom::landmarks
