#pragma once

#include "common/scan/map_patch.hpp"
#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"
#include "server/grid/chunk.hpp"
#include "server/mapping/map_config.hpp"

#include <cstdint>

namespace scanloom::mapping {

/// What weaving a scan may touch, told beforehand, so that memory and work can be bounded.
struct Reach {
    SensorKind kind = SensorKind::kLaser; ///< the layers of lasers and those of sonars have chunks of their own
    grid::CellBox cells;                  ///< whatever the scan can change lies in here; empty when it shows nothing
    double work = 0.0;                    ///< as work.hpp counts it; never far too little
};

/// Cost  the number of beams; no beam is traced.
[[nodiscard]] Reach reach_of(const MapConfig& config, const Sensor& sensor, const Scan& scan);

/// Of taking over a part of an imported map.
[[nodiscard]] Reach reach_of(const MapConfig& config, const MapPatch& patch);

/// How many chunks hold any cell of the box.
[[nodiscard]] std::int64_t chunk_count_of(const grid::CellBox& box) noexcept;

/// The most work that one scan may make: more than any laser's.
inline constexpr double kScanWorkMax = 1e9;

/// How far a sensor may reach at most, cells.
inline constexpr double kReachCellsMax = 8192.0;

/// Whether a sensor's reach is possible at this cell size.
/// Errors  kInvalidField: range_max spans more than kReachCellsMax.
[[nodiscard]] Result<> check_reach(const MapConfig& config, const Sensor& sensor);

/// Errors  kInvalidField: so many cones, so wide, so far (or such a map), at such small cells, that weaving would
///         take seconds.
[[nodiscard]] Result<> check_work(const Reach& reach);

} // namespace scanloom::mapping
