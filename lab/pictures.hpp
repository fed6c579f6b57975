#pragma once

#include "lab/recording.hpp"

#include "server/mapping/snapshot.hpp"
#include "server/tiles/bytes.hpp"
#include "server/tiles/extent.hpp"

#include <span>

namespace scanloom::lab {

/// A map some way through a run.
struct Moment {
    mapping::Snapshot snapshot;
    std::size_t scans = 0; ///< woven so far, at least 1
};

inline constexpr double kPixelsPerMetre = 40.0;

/// The moments side by side, as a PNG: the map (white free, black occupied, mid-grey unknown; where a pixel covers many
/// cells, the one that says most), the path so far in blue, the points of the newest scan in red, the robot where it
/// is, and walkers as orange rings.
/// Throws std::runtime_error when OpenCV fails.
[[nodiscard]] tiles::Bytes strip_png(std::span<const Moment> moments, const Recording& recording,
                                     const tiles::Extent& part);

} // namespace scanloom::lab
