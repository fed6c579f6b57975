#pragma once

#include <numbers>

namespace scanloom {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kDegree = kPi / 180.0; ///< radians

} // namespace scanloom
