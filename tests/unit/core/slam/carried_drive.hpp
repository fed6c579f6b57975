#pragma once

#include "tests/unit/core/slam/other_buildings.hpp"

#include <algorithm>
#include <cstdint>

namespace scanloom::slam {

inline constexpr std::uint64_t kCarried = 200; ///< number of the first scan on the other floor, from 1
inline constexpr std::uint64_t kBack = 280;    ///< of the first scan after it

/// A lap and a quarter of a corridor. In between, the robot is carried to another floor, where it turns, and back.
inline const Drive& carried_drive() {
    static const Drive drive = [] {
        Drive made = drive_along(ring_building(), kLapAndAQuarter, {.scale = 1.03, .turn = 0.004}, 7);
        std::ranges::copy(turn_on_other_floor(made.laser, kBack - kCarried, 7), made.scans.begin() + kCarried - 1);
        return made;
    }();
    return drive;
}

} // namespace scanloom::slam
