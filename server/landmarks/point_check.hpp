#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"

#include <cstddef>
#include <span>
#include <string_view>

namespace scanloom::landmarks {

inline constexpr double kPointCoordinateMax = 1e7;       ///< metres from the origin, each axis
inline constexpr std::size_t kPointsMax = 1'000'000'000; ///< of one cloud

/// Checks that points are usable: squares of their distances and numbers of cells stay far from overflow.
/// @param points  metres
/// @param name    how an error message calls them: "second[3] is not finite"
/// Errors: kInvalidField if a point is not finite or beyond kPointCoordinateMax, with the first such point in the
///     message; kTooLarge if there are more than kPointsMax.
[[nodiscard]] Result<> check_points(std::span<const Point2> points, std::string_view name = "points");

} // namespace scanloom::landmarks
