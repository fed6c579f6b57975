#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace scanloom::foxglove {

/// Returns a stamp in nanoseconds since the epoch or the robot's own start, as messages have it.
/// @param stamp  seconds; a negative one counts as 0, and one above 2^31 - 1 as that, because ROS 2 has 32 bits
[[nodiscard]] inline std::int64_t nanoseconds_of(double stamp) noexcept {
    constexpr double kLatest = std::numeric_limits<std::int32_t>::max();
    constexpr double kSecond = 1e9; // nanoseconds
    const double seconds = std::clamp(stamp, 0.0, kLatest);
    const double whole = std::floor(seconds); // apart, because a double has no room for both
    return static_cast<std::int64_t>(whole) * static_cast<std::int64_t>(kSecond) +
           std::llround((seconds - whole) * kSecond);
}

} // namespace scanloom::foxglove
