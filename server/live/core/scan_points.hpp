#pragma once

#include "common/wire/live.hpp"
#include "server/mapping/snapshot.hpp"

#include <cstddef>

namespace scanloom::live {

/// Returns the end points of the beams that hit an obstacle.
///
/// @param scan  a scan that fits its sensor
/// @param stride  >= 1; the first hit and every `stride`-th one after it are returned
/// @return offsets from the position of the sensor, along the axes of the map frame
[[nodiscard]] wire::ScanPoints points_of(const mapping::FoldedScan& scan, std::size_t stride);

} // namespace scanloom::live
