#pragma once

#include "common/scan/limits.hpp"

#include <cstddef>
#include <limits>

namespace scanloom::access {

/// What the holder of one token may use; beside them the bounds that hold for everybody go on.
struct Limits {
    std::size_t connections = 64;               ///< robots that have a link at once
    double bytes_per_second = 16.0 * (1 << 20); ///< of each link, read; more is read later, so that the robot waits
    std::size_t sessions = 256;                 ///< made with it that exist
    std::size_t sensors = kSensorsMax;          ///< of one robot
    std::size_t beams = kBeamsMax;              ///< of one scan
    std::size_t cells = std::numeric_limits<std::size_t>::max(); ///< of the maps of one session made with it

    friend bool operator==(const Limits&, const Limits&) = default;
};

/// The most that a file may say; what is beyond counts for nobody.
inline constexpr double kBytesPerSecondMin = 1024.0;

/// For whoever is let in where nothing is guarded.
[[nodiscard]] constexpr Limits no_limits() noexcept {
    Limits limits;
    limits.connections = limits.sessions = std::numeric_limits<std::size_t>::max();
    limits.bytes_per_second = std::numeric_limits<double>::infinity();
    return limits;
}

} // namespace scanloom::access
