#pragma once

#include <numbers>

namespace scanloom::robot {

/// The reference robot's body: a disc with a differential drive. (Wheelbase 0.230 m, wheel radius 0.035 m; the unicycle
/// model needs neither.)
inline constexpr double kBodyRadius = 0.15;          ///< metres
inline constexpr double kForwardMax = 0.70;          ///< metres per second
inline constexpr double kTurnMax = std::numbers::pi; ///< radians per second
inline constexpr double kControlPeriod = 0.05;       ///< seconds: 20 Hz

} // namespace scanloom::robot
