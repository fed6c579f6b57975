#include "core/mapping/reach.hpp"

#include "common/scan/limits.hpp"
#include "core/mapping/map_patch_cells.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scanloom::mapping {
namespace {

constexpr double kWorkPerSonarCell = 32.0; // two roots and an arc tangent

} // namespace

double reached(RangeMm range, const ModelGeometry& geometry) noexcept {
    const auto reading = reading_of(range, geometry.readings);
    if (!reading) return 0.0;
    return reading->is_hit ? std::min(geometry.readings.range_max, reading->metres + geometry.half_band())
                           : reading->metres;
}

double work_of_beam(const Reading& reading, const RayGeometry& geometry) noexcept {
    const double cells = reading.metres / geometry.cell_size;
    const double disc = geometry.hit_radius / geometry.cell_size;
    return 2.0 * cells + std::numbers::pi * disc * disc + 2.0;
}

double work_of_cone(double aperture, RangeMm range, const ModelGeometry& geometry) noexcept {
    const double cells = reached(range, geometry) / geometry.cell_size;
    return kWorkPerSonarCell * 0.5 * aperture * cells * cells + 2.0 * cells + 1.0;
}

ReadingRules rules_of(const MapConfig& config, const Sensor& sensor) noexcept {
    return {sensor.range_min, sensor.range_max, config.drop_no_return};
}

namespace {

/// Returns an upper bound of a sector's width. For explicit angles, a closer bound would need a sort.
double sector_width(double aperture, const Sensor& sensor, const Scan& scan) {
    const auto& angles = scan.angles ? *scan.angles : sensor.angles;
    const auto* uniform = std::get_if<UniformAngles>(&angles);
    return uniform != nullptr ? std::max(aperture, std::abs(uniform->increment)) : 2.0 * std::numbers::pi;
}

/// Returns the shortest reading of at least `metres`, with the same comparison as reading_of().
RangeMm first_from(double metres) {
    auto range = static_cast<RangeMm>(std::max(std::floor(metres * 1000.0) - 1.0, 0.0));
    while (range * 0.001 < metres) ++range;
    return range;
}

/// Sums over the readings of a scan in whole millimetres, computed in one pass of integers for all layers.
struct Readings {
    RangeMm longest_hit = 0;
    std::uint64_t hits = 0;
    std::uint64_t sum = 0; ///< of the hits
    std::uint64_t sum_of_squares = 0;
    std::uint64_t no_returns = 0;
};

Readings readings_of(const Scan& scan, const ReadingRules& rules) {
    const RangeMm least = std::max<RangeMm>(first_from(rules.range_min), 1);
    const RangeMm most = first_from(rules.range_max); // this range and beyond: no return
    Readings readings;
    std::uint64_t valid = 0;
    for (const RangeMm range : scan.ranges) {
        const RangeMm hit = range >= least && range < most ? range : 0;
        readings.longest_hit = std::max(readings.longest_hit, hit);
        readings.hits += hit != 0 ? 1 : 0;
        readings.sum += hit;
        readings.sum_of_squares += std::uint64_t{hit} * hit;
        valid += range >= least ? 1 : 0;
    }
    if (!rules.drop_no_return) readings.no_returns = valid - readings.hits;
    return readings;
}

/// The lengths that the readings show, in metres.
struct Extent {
    double longest = 0.0;
    double sum = 0.0;
    double sum_of_squares = 0.0;
};

/// Applies range_max only to the longest hit, not to the bands behind the other hits; therefore the result is never too
/// small.
Extent extent_of(const Readings& readings, const ModelGeometry& geometry) {
    const double band = geometry.half_band();
    const double range_max = geometry.readings.range_max;
    const auto hits = static_cast<double>(readings.hits);
    const auto no_returns = static_cast<double>(readings.no_returns);
    const double sum = 1e-3 * static_cast<double>(readings.sum);
    Extent extent;
    if (readings.hits > 0) extent.longest = std::min(range_max, 1e-3 * readings.longest_hit + band);
    if (readings.no_returns > 0) extent.longest = range_max;
    extent.sum = sum + hits * band + no_returns * range_max;
    extent.sum_of_squares = 1e-6 * static_cast<double>(readings.sum_of_squares) + 2.0 * band * sum +
                            hits * band * band + no_returns * range_max * range_max;
    return extent;
}

/// Returns the work of sectors that do not overlap.
double work_of_sectors(const Extent& extent, double width, double per_metre) {
    const double disc = std::numbers::pi * extent.longest * extent.longest;
    return std::min(disc, 0.5 * width * extent.sum_of_squares) * per_metre * per_metre + 2.0 * extent.sum * per_metre;
}

double work_of_rays(const MapConfig& config, const Sensor& sensor, const Scan& scan) {
    const RayGeometry geometry{rules_of(config, sensor), config.ray_model, config.hit_radius, config.cell_size};
    double work = 0.0;
    for (const RangeMm range : scan.ranges) {
        if (const auto reading = reading_of(range, geometry.readings)) work += work_of_beam(*reading, geometry);
    }
    return work;
}

grid::CellBox square_around(const Pose2& T_map_sensor, double metres, double per_metre) {
    const auto floor_cell = [](double cells) { return static_cast<std::int32_t>(std::floor(cells)); };
    const double x = T_map_sensor.x * per_metre;
    const double y = T_map_sensor.y * per_metre;
    const double radius = metres * per_metre + 1.0;
    return {floor_cell(x - radius), floor_cell(y - radius), floor_cell(x + radius) + 1, floor_cell(y + radius) + 1};
}

Reach reach_of_laser(const MapConfig& config, const Sensor& sensor, const Scan& scan) {
    const ReadingRules rules = rules_of(config, sensor);
    const Readings readings = readings_of(scan, rules);
    const auto counted = extent_of(readings, {rules, config.himm_obstacle_thickness, config.cell_size});
    const auto seen = extent_of(readings, {rules, config.obstacle_thickness, config.cell_size});
    const double longest = std::max(seen.longest, counted.longest);
    if (longest == 0.0) return {};

    const double per_metre = 1.0 / config.cell_size;
    const auto aperture_or = [&](double aperture) { return sensor.aperture > 0.0 ? sensor.aperture : aperture; };
    const bool by_sectors = config.ray_model == RayModel::kInverseSensorModel;
    Reach reach;
    reach.cells = square_around(compose(scan.pose.value_or(Pose2()), sensor.mount),
                                longest + (by_sectors ? 0.0 : config.hit_radius), per_metre);
    reach.work =
        work_of_sectors(counted, sector_width(aperture_or(config.himm_beam_aperture), sensor, scan), per_metre);
    reach.work += by_sectors
                      ? work_of_sectors(seen, sector_width(aperture_or(config.beam_aperture), sensor, scan), per_metre)
                      : work_of_rays(config, sensor, scan);
    reach.work += 2.0 * kWorkPerChunk * static_cast<double>(chunk_count_of(reach.cells)); // marks, classes
    return reach;
}

Reach reach_of_sonar(const MapConfig& config, const Sensor& sensor, const Scan& scan) {
    const ModelGeometry geometry{rules_of(config, sensor), config.sonar_obstacle_thickness, config.cell_size};
    const auto extent = extent_of(readings_of(scan, geometry.readings), geometry);
    if (extent.longest == 0.0) return {};
    const double aperture = sensor.aperture > 0.0 ? sensor.aperture : config.sonar_beam_aperture;
    Reach reach{
        SensorKind::kSonar,
        square_around(compose(scan.pose.value_or(Pose2()), sensor.mount), extent.longest, 1.0 / config.cell_size), 0.0};
    for (const RangeMm range : scan.ranges) reach.work += work_of_cone(aperture, range, geometry);
    return reach;
}

} // namespace

Reach reach_of(const MapConfig& config, const Sensor& sensor, const Scan& scan) {
    return sensor.kind == SensorKind::kLaser ? reach_of_laser(config, sensor, scan)
                                             : reach_of_sonar(config, sensor, scan);
}

Reach reach_of(const MapConfig& config, const MapPatch& patch) {
    const auto cells = cells_of(patch, config.cell_size);
    const auto ours = static_cast<double>(cells.width()) * static_cast<double>(cells.height());
    return {SensorKind::kLaser, cells, 8.0 * std::max(ours, static_cast<double>(patch.cells.size()))};
}

std::int64_t chunk_count_of(const grid::CellBox& box) noexcept {
    const grid::ChunkBox chunks = grid::chunks_of(box);
    return (chunks.ci_end - chunks.ci_begin) * (chunks.cj_end - chunks.cj_begin);
}

Result<> check_reach(const MapConfig& config, const Sensor& sensor) {
    if (sensor.range_max <= kReachCellsMax * config.cell_size) return {};
    return Error{Errc::kInvalidField,
                 fmt::format("range_max is {} metres, more than {} cells of {} metres; use larger cells, or state the "
                             "range that is wanted in the map",
                             sensor.range_max, kReachCellsMax, config.cell_size)};
}

Result<> check_work(const Reach& reach) {
    if (reach.work <= kScanWorkMax) return {};
    return Error{
        Errc::kInvalidField,
        "this covers too many cells to be integrated at once; use larger cells, or of a sensor fewer beams in a "
        "scan, or a smaller range_max"};
}

} // namespace scanloom::mapping
