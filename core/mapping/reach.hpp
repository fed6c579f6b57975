#pragma once

#include "common/scan/limits.hpp"
#include "common/scan/log_entry.hpp"
#include "common/scan/reading.hpp"
#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"
#include "core/grid/chunk.hpp"
#include "core/mapping/map_config.hpp"
#include "core/mapping/ray_models.hpp"
#include "core/mapping/sonar_model.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

/// Estimates of work, used to integrate a scan in slices. The unit is about one visited cell or row of cells.
namespace scanloom::mapping {

/// Fixed work for each chunk that a scan changes.
inline constexpr double kWorkPerChunk = 512.0;

/// Work for a chunk in which a sweep has a verdict, for all laser layers together.
inline constexpr double kWorkPerSweptChunk = 2048.0;

/// Returns the work of tracing one beam.
/// @param reading   of the beam
/// @param geometry  ray model, hit radius and cell size
[[nodiscard]] double work_of_beam(const Reading& reading, const RayGeometry& geometry) noexcept;

/// Returns the work of one sonar cone, where each cell costs more than with a laser.
/// @param aperture  full width of the cone, radians
/// @param range     millimetres, kInvalidRange or kNoReturn
/// @param geometry  range limits, thickness and cell size
[[nodiscard]] double work_of_cone(double aperture, RangeMm range, const ModelGeometry& geometry) noexcept;

/// Returns the distance up to which a reading shows anything, in metres; 0 if it shows nothing.
/// @param range     millimetres, kInvalidRange or kNoReturn
/// @param geometry  range limits, thickness and cell size
[[nodiscard]] double reached(RangeMm range, const ModelGeometry& geometry) noexcept;

/// Returns how the readings of a sensor are interpreted in a session's maps.
/// @param config  of the session
/// @param sensor  that took the readings
[[nodiscard]] ReadingRules rules_of(const MapConfig& config, const Sensor& sensor) noexcept;

/// Upper bounds of what integrating a scan may change, computed beforehand to limit memory and work.
struct Reach {
    SensorKind kind = SensorKind::kLaser; ///< laser and sonar layers have separate chunks
    grid::CellBox cells;                  ///< contains every cell that the scan can change; empty if it shows nothing
    double work = 0.0;                    ///< in the unit of kScanWorkMax; never much too low
};

/// Returns the reach of a scan.
/// @param config  of the session
/// @param sensor  that took the scan
/// @param scan    with as many ranges as beams; without a pose, it counts as taken at the origin
/// Cost: proportional to the number of beams; no beam is traced.
[[nodiscard]] Reach reach_of(const MapConfig& config, const Sensor& sensor, const Scan& scan);

/// Returns the reach of importing a part of a map.
/// @param config  of the session
/// @param patch   metres, map frame
[[nodiscard]] Reach reach_of(const MapConfig& config, const MapPatch& patch);

/// Returns the number of chunks that contain any cell of the box.
[[nodiscard]] std::int64_t chunk_count_of(const grid::CellBox& box) noexcept;

/// Limit of the work of one scan, greater than that of any laser scan.
inline constexpr double kScanWorkMax = 1e9;

/// Checks a sensor's range against the cell size.
/// @param config  its cell size is used
/// @param sensor  its range_max is used, metres
/// Errors: kInvalidField if range_max spans more than kReachCellsMax cells.
[[nodiscard]] Result<> check_reach(const MapConfig& config, const Sensor& sensor);

/// Checks the work of integrating a scan or importing a part of a map.
/// @param reach  of the scan or the part of a map
/// Errors: kInvalidField if the work exceeds kScanWorkMax and would take seconds: too many, too wide or too long cones,
///         or too large a map, for the cell size.
[[nodiscard]] Result<> check_work(const Reach& reach);

} // namespace scanloom::mapping
