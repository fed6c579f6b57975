#pragma once

#include "load/core/micros.hpp"

#include <cstdint>
#include <string>

/// Formats figures for people.
namespace scanloom::load {

[[nodiscard]] std::string grouped(std::uint64_t count); ///< 1,234,567
[[nodiscard]] std::string whole(double count);          ///< the rounded value, like grouped()
[[nodiscard]] std::string as_milliseconds(Micros time); ///< 0.42, 7.5, 123, 4,567
[[nodiscard]] std::string as_bytes(double bytes);       ///< 512 B, 1.5 KiB, 12.3 MiB

/// Makes text from other programs safe for a terminal: replaces control characters by '?'.
[[nodiscard]] std::string harmless(std::string text);

/// Returns 0 if no time has passed.
[[nodiscard]] constexpr double per_second(double count, double seconds) noexcept {
    return seconds > 0.0 ? count / seconds : 0.0;
}
[[nodiscard]] constexpr double per_second(std::uint64_t count, double seconds) noexcept {
    return per_second(static_cast<double>(count), seconds);
}

} // namespace scanloom::load
