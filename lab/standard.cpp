#include "lab/standard.hpp"

#include "lab/visibility.hpp"

#include <algorithm>
#include <cmath>

namespace scanloom::lab {
namespace {

/// Returns the box of the truth with a margin, so that walls that maps place outside the room are found, also at 0.5 m.
grid::CellBox box_of(const robot::TruthGrid& truth) {
    const auto margin = static_cast<std::int32_t>(std::ceil(2.0 / truth.cell_size));
    return {truth.i_begin - margin, truth.j_begin - margin, truth.i_begin + truth.width + margin,
            truth.j_begin + truth.height + margin};
}

/// Marks the cells that a walker covered or that scans of it may mark: within half the thickness of obstacles plus the
/// tolerance of the scores.
void mark_discs(const std::vector<robot::Disc>& discs, double reach, double cell_size, std::uint8_t value,
                CellMask& mask) {
    for (const robot::Disc& disc : discs) {
        const double radius = disc.radius + reach;
        const auto first = [&](double metres) { return static_cast<std::int32_t>(std::floor(metres / cell_size)); };
        for (std::int32_t j = first(disc.centre.y - radius); j <= first(disc.centre.y + radius); ++j) {
            for (std::int32_t i = first(disc.centre.x - radius); i <= first(disc.centre.x + radius); ++i) {
                const Point2 centre{(i + 0.5) * cell_size, (j + 0.5) * cell_size};
                if (mask.contains({i, j}) && norm(centre - disc.centre) <= radius) mask.at({i, j}) = value;
            }
        }
    }
}

} // namespace

Standard make_standard(const std::vector<Pose2>& path, double cell_size_m) {
    const robot::World world = world_of("room");
    const robot::TruthGrid grid = robot::truth_of(world, cell_size_m);
    Standard standard{TruthCells(box_of(grid), robot::Truth::kOutside), {}};
    for_each_cell(standard.truth.box, [&](grid::Cell cell) { standard.truth.at(cell) = grid.at(cell.i, cell.j); });
    standard.seen = visible_cells(world, grid, reference_laser(), path, standard.truth.box);
    return standard;
}

CellMask walked_cells(const Recording& recording, const mapping::MapConfig& config, const grid::CellBox& box) {
    const double cell_size = config.cell_size;
    const double reach = std::max(config.obstacle_thickness, cell_size) / 2.0 + kTolerance * cell_size;
    CellMask walked(box, 0);
    for (const auto& discs : recording.walkers) mark_discs(discs, reach, cell_size, 1, walked);
    mark_discs(recording.walkers.back(), reach, cell_size, 0, walked);
    return walked;
}

} // namespace scanloom::lab
