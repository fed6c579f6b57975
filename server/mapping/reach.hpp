#pragma once

#include "common/scan/scan.hpp"
#include "server/grid/chunk.hpp"
#include "server/mapping/inverse_sensor_model.hpp"
#include "server/mapping/map_config.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

namespace scanloom::mapping {

/// What weaving a scan may touch, told beforehand, so that memory and work can be bounded.
struct Reach {
    grid::CellBox cells; ///< whatever the scan can change lies in here; empty when it shows nothing
    double work = 0.0;   ///< about how many cells and rows of cells will be visited; never far too few
};

/// Cost  the number of beams; no beam is traced.
[[nodiscard]] Reach reach_of(const MapConfig& config, const Sensor& sensor, const Scan& scan);

/// How many of the sectors, from the first, can be woven with this much work; at least one of them.
/// @param work  what there is, as Reach::work; what the sectors take is taken from it.
[[nodiscard]] std::size_t sectors_within(double& work, std::span<const Sector> sectors, std::span<const RangeMm> ranges,
                                         const ModelGeometry& geometry);

/// How many chunks hold any cell of the box.
[[nodiscard]] std::int64_t chunk_count_of(const grid::CellBox& box) noexcept;

} // namespace scanloom::mapping
