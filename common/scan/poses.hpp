#pragma once

#include <cstdint>

namespace scanloom {

/// What the poses of a robot's scans are, and therefore how they are used.
enum class Poses : std::uint8_t {
    kMap,      ///< poses in the map frame; they are trusted
    kOdometry, ///< odometry, which drifts
    kNone,     ///< the robot does not know its poses
};

} // namespace scanloom
