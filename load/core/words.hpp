#pragma once

#include "load/core/micros.hpp"

#include <cstdint>
#include <string>

/// Figures as people read them.
namespace scanloom::load {

[[nodiscard]] std::string grouped(std::uint64_t count); ///< 1,234,567
[[nodiscard]] std::string whole(double count);          ///< the same, rounded
[[nodiscard]] std::string as_milliseconds(Micros time); ///< 0.42, 7.5, 123, 4,567
[[nodiscard]] std::string as_bytes(double bytes);       ///< 512 B, 1.5 KiB, 12.3 MiB

/// What somebody else wrote, so that it can do nothing to a terminal: '?' in place of control characters.
[[nodiscard]] std::string harmless(std::string text);

/// 0 where no time has passed.
[[nodiscard]] constexpr double per_second(double count, double seconds) noexcept {
    return seconds > 0.0 ? count / seconds : 0.0;
}

} // namespace scanloom::load
