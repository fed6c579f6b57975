#include "server/mapping/reach.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scanloom::mapping {
namespace {

/// An upper bound of a sector's width, which for explicit angles would cost a sort to know better.
double sector_width(const MapConfig& config, const Sensor& sensor, const Scan& scan) {
    const double aperture = sensor.aperture > 0.0 ? sensor.aperture : config.beam_aperture;
    const auto& angles = scan.angles ? *scan.angles : sensor.angles;
    const auto* uniform = std::get_if<UniformAngles>(&angles);
    return uniform != nullptr ? std::max(aperture, std::abs(uniform->increment)) : 2.0 * std::numbers::pi;
}

/// How far a reading shows anything; metres, 0 when it shows nothing.
double reached(RangeMm reading, const ModelGeometry& geometry) {
    const double z = reading == kNoReturn ? HUGE_VAL : reading * 0.001;
    if (reading == kInvalidRange || z < geometry.range_min) return 0.0;
    return std::min(geometry.range_max, z + std::max(geometry.thickness, geometry.cell_size) / 2.0);
}

std::int32_t floor_cell(double cells) { return static_cast<std::int32_t>(std::floor(cells)); }

} // namespace

Reach reach_of(const MapConfig& config, const Sensor& sensor, const Scan& scan) {
    if (sensor.kind != SensorKind::kLaser) return {};
    const ModelGeometry geometry = geometry_of(config, sensor);
    double longest = 0.0; // metres
    double sum = 0.0;
    double sum_of_squares = 0.0;
    for (const RangeMm reading : scan.ranges) {
        const double metres = reached(reading, geometry);
        longest = std::max(longest, metres);
        sum += metres;
        sum_of_squares += metres * metres;
    }
    if (longest == 0.0) return {};

    const double per_metre = 1.0 / config.cell_size;
    const Pose2 T_map_sensor = compose(scan.pose, sensor.mount);
    const double x = T_map_sensor.x * per_metre;
    const double y = T_map_sensor.y * per_metre;
    const double radius = longest * per_metre + 1.0;
    const double disc = std::numbers::pi * longest * longest;
    const double area = std::min(disc, 0.5 * sector_width(config, sensor, scan) * sum_of_squares);
    return {{floor_cell(x - radius), floor_cell(y - radius), floor_cell(x + radius) + 1, floor_cell(y + radius) + 1},
            area * per_metre * per_metre + 2.0 * sum * per_metre};
}

std::size_t sectors_within(double& work, std::span<const Sector> sectors, std::span<const RangeMm> ranges,
                           const ModelGeometry& geometry) {
    std::size_t count = 0;
    while (count < sectors.size() && (count == 0 || work > 0.0)) {
        const Sector& sector = sectors[count++];
        const double cells = reached(ranges[sector.beam], geometry) / geometry.cell_size;
        const double sine = sector.low.x * sector.high.y - sector.low.y * sector.high.x; // nearly the angle
        work -= 0.5 * sine * cells * cells + 2.0 * cells + 1.0;
    }
    return count;
}

std::int64_t chunk_count_of(const grid::CellBox& box) noexcept {
    const grid::ChunkBox chunks = grid::chunks_of(box);
    return (chunks.ci_end - chunks.ci_begin) * (chunks.cj_end - chunks.cj_begin);
}

} // namespace scanloom::mapping
