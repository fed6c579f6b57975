#pragma once

#include "lab/recording.hpp"

#include "core/mapping/snapshot.hpp"
#include "server/tiles/bytes.hpp"
#include "server/tiles/map_image.hpp"

#include <span>

namespace scanloom::lab {

/// A map at one moment of a run.
struct Moment {
    mapping::Snapshot snapshot;
    std::size_t scans = 0; ///< integrated so far, at least 1
};

inline constexpr double kPixelsPerMetre = 40.0;

/// Draws the moments side by side as a PNG: the map (white free, black occupied, mid-grey unknown; of many cells in a
/// pixel, the most informative one), the trajectory so far in blue, the points of the newest scan in red, the robot at
/// its pose, and walkers as orange rings.
/// Errors: throws std::runtime_error if OpenCV fails.
[[nodiscard]] tiles::Bytes strip_png(std::span<const Moment> moments, const Recording& recording,
                                     const tiles::Extent& part);

} // namespace scanloom::lab
