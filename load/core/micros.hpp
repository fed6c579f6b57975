#pragma once

#include <cstdint>

namespace scanloom::load {

/// Microseconds: a duration, or a time since the start of the run.
using Micros = std::int64_t;

inline constexpr Micros kMillisecond = 1000;
inline constexpr Micros kSecond = 1'000'000;

[[nodiscard]] constexpr double in_seconds(Micros time) noexcept {
    return static_cast<double>(time) / static_cast<double>(kSecond);
}

} // namespace scanloom::load
