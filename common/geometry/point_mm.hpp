#pragma once

#include "common/geometry/pose2.hpp"

#include <cmath>
#include <cstdint>

namespace scanloom {

/// A point in whole millimetres, the unit of the readings.
struct PointMm {
    std::int32_t x = 0; ///< millimetres
    std::int32_t y = 0; ///< millimetres

    friend bool operator==(const PointMm&, const PointMm&) = default;
};

/// Rounds a point to millimetres.
/// @param metres  in any frame, which the result keeps
/// Precondition: each coordinate is within 2e6 m of the origin, so that it fits 32 bits.
[[nodiscard]] inline PointMm in_millimetres(const Point2& metres) noexcept {
    return {static_cast<std::int32_t>(std::lround(metres.x * 1000.0)),
            static_cast<std::int32_t>(std::lround(metres.y * 1000.0))};
}

/// Converts a point to metres. in_millimetres() of the result is the same point.
[[nodiscard]] inline Point2 in_metres(const PointMm& point) noexcept { return {point.x * 0.001, point.y * 0.001}; }

} // namespace scanloom
