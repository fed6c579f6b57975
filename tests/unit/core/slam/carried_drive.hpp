#pragma once

#include "tests/unit/core/slam/drive.hpp"

#include <cstdint>
#include <random>

namespace scanloom::slam {

inline constexpr std::uint64_t kCarried = 200; ///< number of the first scan of another building, from 1
inline constexpr std::uint64_t kBack = 280;    ///< of the first scan after it

/// A lap and a quarter of a corridor. In between, the robot is carried to another building, where it turns, and back.
inline const Drive& carried_drive() {
    static const Drive drive = [] {
        Drive made = drive_along(ring_building(), kLapAndAQuarter, {.scale = 1.03, .turn = 0.004}, 7);
        testing_support::Building elsewhere;
        elsewhere.add_box(-3.0, -2.0, 5.0, 4.0);
        elsewhere.add_box(1.0, 1.0, 1.5, 1.6);
        std::mt19937 random(7);
        for (std::uint64_t n = kCarried; n < kBack; ++n) {
            const Pose2 pose{0.3, 0.2, 0.05 * static_cast<double>(n - kCarried)};
            made.scans[n - 1] = elsewhere.scan(made.laser, pose, 0.01, random);
        }
        return made;
    }();
    return drive;
}

} // namespace scanloom::slam
