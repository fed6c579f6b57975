#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"

#include <cstddef>
#include <span>
#include <string_view>

namespace scanloom::landmarks {

inline constexpr double kPointCoordinateMax = 1e7;       ///< metres from the origin, each axis
inline constexpr std::size_t kPointsMax = 1'000'000'000; ///< of one cloud

/// Whether points can be worked with: squares of their distances and counts of cells stay far from overflow.
/// @param name  what they are called in the sentence of an error: "second[3] is not finite"
/// Errors  kInvalidField: one is not finite or lies beyond kPointCoordinateMax; the message names the first of them.
///         kTooLarge: more than kPointsMax.
[[nodiscard]] Result<> check_points(std::span<const Point2> points, std::string_view name = "points");

} // namespace scanloom::landmarks
