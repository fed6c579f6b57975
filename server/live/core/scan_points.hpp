#pragma once

#include "common/wire/live.hpp"
#include "server/mapping/snapshot.hpp"

#include <cstddef>

namespace scanloom::live {

/// Where the beams of a scan ended at something. Of its hits the first is told, then every `stride`-th.
/// Frames  the points are offsets from the sensor's place, along the axes of the map.
/// Pre     stride >= 1; the scan fits its sensor.
[[nodiscard]] wire::ScanPoints points_of(const mapping::FoldedScan& scan, std::size_t stride);

} // namespace scanloom::live
