#pragma once

#include "common/scan/limits.hpp"

#include <cstddef>
#include <limits>

namespace scanloom::access {

/// The limits of one token. The server's own bounds apply in addition.
struct Limits {
    std::size_t connections = 64;               ///< robots connected at once
    double bytes_per_second = 16.0 * (1 << 20); ///< read from each link; the server reads later bytes after a pause
    std::size_t sessions = 256;                 ///< existing sessions that were created with the token
    std::size_t sensors = kSensorsMax;          ///< of one robot
    std::size_t beams = kBeamsMax;              ///< of one scan
    std::size_t cells = std::numeric_limits<std::size_t>::max(); ///< of the maps of one session created with the token

    friend bool operator==(const Limits&, const Limits&) = default;
};

/// The smallest `bytes_per_second` that a token file may have.
inline constexpr double kBytesPerSecondMin = 1024.0;

/// Returns the limits that apply if the server has no tokens: only those of the protocol.
[[nodiscard]] constexpr Limits no_limits() noexcept {
    Limits limits;
    limits.connections = limits.sessions = std::numeric_limits<std::size_t>::max();
    limits.bytes_per_second = std::numeric_limits<double>::infinity();
    return limits;
}

} // namespace scanloom::access
