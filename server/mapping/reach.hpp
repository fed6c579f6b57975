#pragma once

#include "common/scan/scan.hpp"
#include "server/mapping/chunk.hpp"
#include "server/mapping/map_config.hpp"

#include <cstdint>

namespace scanloom::mapping {

/// What weaving a scan may touch, told beforehand, so that memory and work can be bounded.
struct Reach {
    CellBox cells;     ///< whatever the scan can change lies in here; empty when it shows nothing
    double work = 0.0; ///< about how many cells and rows of cells will be visited; never far too few
};

/// Cost  the number of beams; no beam is traced.
[[nodiscard]] Reach reach_of(const MapConfig& config, const Sensor& sensor, const Scan& scan);

/// How many chunks hold any cell of the box.
[[nodiscard]] std::int64_t chunk_count_of(const CellBox& box) noexcept;

} // namespace scanloom::mapping
