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

std::int32_t floor_cell(double cells) { return static_cast<std::int32_t>(std::floor(cells)); }

} // namespace

Reach reach_of(const MapConfig& config, const Sensor& sensor, const Scan& scan) {
    if (sensor.kind != SensorKind::kLaser) return {};
    const double half_band = std::max(config.obstacle_thickness, config.cell_size) / 2.0;
    double longest = 0.0; // metres
    double sum = 0.0;
    double sum_of_squares = 0.0;
    for (const RangeMm reading : scan.ranges) {
        const double z = reading == kNoReturn ? HUGE_VAL : reading * 0.001;
        if (reading == kInvalidRange || z < sensor.range_min) continue;
        const double reached = std::min(sensor.range_max, z + half_band);
        longest = std::max(longest, reached);
        sum += reached;
        sum_of_squares += reached * reached;
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

std::int64_t chunk_count_of(const CellBox& box) noexcept {
    const ChunkBox chunks = chunks_of(box);
    return (chunks.ci_end - chunks.ci_begin) * (chunks.cj_end - chunks.cj_begin);
}

} // namespace scanloom::mapping
