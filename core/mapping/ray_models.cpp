#include "core/mapping/ray_models.hpp"

#include <algorithm>
#include <cmath>

namespace scanloom::mapping {
namespace {

/// Marks all cells whose centres lie in the disc. Lengths are in cells.
void hit_disc(ScanMarks& marks, GridPoint centre, double radius) {
    const auto first_row = static_cast<std::int32_t>(std::ceil(centre.y - radius - 0.5));
    const auto last_row = static_cast<std::int32_t>(std::floor(centre.y + radius - 0.5));
    for (std::int32_t j = first_row; j <= last_row; ++j) {
        const double dy = j + 0.5 - centre.y;
        const double half = std::sqrt(std::max(0.0, radius * radius - dy * dy));
        const auto first = static_cast<std::int32_t>(std::ceil(centre.x - half - 0.5));
        const auto last = static_cast<std::int32_t>(std::floor(centre.x + half - 0.5));
        for (std::int32_t i = first; i <= last; ++i) marks.hit({i, j});
    }
}

} // namespace

void trace_beam(ScanMarks& marks, const Direction& beam, const Reading& reading, const SensorOnGrid& sensor,
                const RayGeometry& geometry) {
    const double per_metre = 1.0 / geometry.cell_size;
    const double length = reading.metres * per_metre;
    const Direction direction = sensor.to_map(beam);
    const GridPoint to{sensor.at.x + direction.x * length, sensor.at.y + direction.y * length};

    const grid::Cell last = cell_at(to);
    const auto visit = [&](grid::Cell cell) {
        if (!(reading.is_hit && cell == last)) marks.pass(cell);
    };
    if (geometry.model == RayModel::kTraversal) {
        traverse(sensor.at, to, visit);
    } else {
        bresenham(cell_at(sensor.at), last, visit);
    }
    if (!reading.is_hit) return;
    marks.hit(last);
    if (geometry.hit_radius > 0.0) hit_disc(marks, to, geometry.hit_radius * per_metre);
}

} // namespace scanloom::mapping
