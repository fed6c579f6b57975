#include "sim/ground_truth.hpp"

#include "common/ros_map/description.hpp"
#include "common/ros_map/pgm.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>

namespace scanloom::sim {
namespace {

/// Reachability is computed on cells of at most this size: larger ones would close doors.
constexpr double kReachCellMax = 0.1; // metres

/// A side within this share of a cell from a border counts as on the border.
constexpr double kSnapCells = 1e-6;

std::int32_t first_cell(double metres, double cells_per_metre) {
    return static_cast<std::int32_t>(std::floor(metres * cells_per_metre + kSnapCells));
}

std::int32_t end_cell(double metres, double cells_per_metre) {
    return static_cast<std::int32_t>(std::ceil(metres * cells_per_metre - kSnapCells));
}

GroundTruthGrid blank_grid(const World& world, double cell_size_m) {
    const Box all = bounds_of(world);
    const double cells_per_metre = 1.0 / cell_size_m;
    GroundTruthGrid grid{
        cell_size_m, first_cell(all.x_min, cells_per_metre), first_cell(all.y_min, cells_per_metre), 0, 0, {}};
    grid.width = end_cell(all.x_max, cells_per_metre) - grid.i_begin;
    grid.height = end_cell(all.y_max, cells_per_metre) - grid.j_begin;
    grid.cells.assign(static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height),
                      GroundTruth::kOutside);
    return grid;
}

/// Calls visit(GroundTruth&, index) for the cells of the grid that a box occupies.
template <class Visit>
void for_cells_of(const Box& box, GroundTruthGrid& grid, Visit&& visit) {
    const double cells_per_metre = 1.0 / grid.cell_size;
    const auto columns = std::pair{std::max(0, first_cell(box.x_min, cells_per_metre) - grid.i_begin),
                                   std::min(grid.width, end_cell(box.x_max, cells_per_metre) - grid.i_begin)};
    const auto rows = std::pair{std::max(0, first_cell(box.y_min, cells_per_metre) - grid.j_begin),
                                std::min(grid.height, end_cell(box.y_max, cells_per_metre) - grid.j_begin)};
    for (std::int32_t row = rows.first; row < rows.second; ++row) {
        for (std::int32_t column = columns.first; column < columns.second; ++column) {
            const auto index =
                static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.width) + static_cast<std::size_t>(column);
            visit(grid.cells[index], index);
        }
    }
}

/// Marks a cell with unknown parts, which cannot be passed. None remain in the result.
constexpr GroundTruth kClosed = static_cast<GroundTruth>(3);

void mark_unknown_and_solids(const World& world, GroundTruthGrid& grid) {
    for (const Box& box : world.unknown) {
        for_cells_of(box, grid, [](GroundTruth& cell, std::size_t) { cell = kClosed; });
    }
    for (const Box& box : world.solids) {
        for_cells_of(box, grid, [](GroundTruth& cell, std::size_t) { cell = GroundTruth::kOccupied; });
    }
}

/// Marks as free what is connected to the floors (four neighbours).
void mark_free(const World& world, GroundTruthGrid& grid) {
    std::vector<std::size_t> open;
    const auto reach = [&](GroundTruth& cell, std::size_t index) {
        if (cell != GroundTruth::kOutside) return;
        cell = GroundTruth::kFree;
        open.push_back(index);
    };
    for (const Box& floor : world.floors) for_cells_of(floor, grid, reach);
    const auto width = static_cast<std::size_t>(grid.width);
    while (!open.empty()) {
        const std::size_t at = open.back();
        open.pop_back();
        if (at % width > 0) reach(grid.cells[at - 1], at - 1);
        if (at % width + 1 < width) reach(grid.cells[at + 1], at + 1);
        if (at >= width) reach(grid.cells[at - width], at - width);
        if (at + width < grid.cells.size()) reach(grid.cells[at + width], at + width);
    }
}

} // namespace

GroundTruthGrid ground_truth_of(const World& world, double cell_size_m) {
    GroundTruthGrid grid = blank_grid(world, cell_size_m);
    const int parts = static_cast<int>(std::ceil(cell_size_m / kReachCellMax - 1e-9));
    mark_unknown_and_solids(world, grid);
    if (parts == 1) {
        mark_free(world, grid);
    } else {
        GroundTruthGrid finer = blank_grid(world, cell_size_m / parts);
        mark_unknown_and_solids(world, finer);
        mark_free(world, finer);
        std::size_t n = 0;
        for (std::int32_t j = grid.j_begin; j < grid.j_begin + grid.height; ++j) {
            for (std::int32_t i = grid.i_begin; i < grid.i_begin + grid.width; ++i, ++n) {
                // no solid is in the cell, so one part of it decides for all
                const bool is_reached = finer.at(i * parts, j * parts) == GroundTruth::kFree;
                if (grid.cells[n] == GroundTruth::kOutside && is_reached) grid.cells[n] = GroundTruth::kFree;
            }
        }
    }
    std::ranges::replace(grid.cells, kClosed, GroundTruth::kOutside);
    return grid;
}

namespace {

std::uint8_t grey_of(GroundTruth truth) {
    switch (truth) {
    case GroundTruth::kOccupied: return kRosGreyOccupied;
    case GroundTruth::kFree: return kRosGreyFree;
    case GroundTruth::kOutside: break;
    }
    return kRosGreyUnknown;
}

} // namespace

std::vector<std::uint8_t> ground_truth_pgm(const GroundTruthGrid& truth) {
    const auto width = static_cast<std::size_t>(truth.width);
    const auto height = static_cast<std::size_t>(truth.height);
    const auto header = ros_pgm_header(width, height, truth.cell_size);
    std::vector<std::uint8_t> pgm(header.begin(), header.end());
    pgm.reserve(header.size() + width * height);
    for (std::size_t row = height; row-- > 0;) {
        std::ranges::transform(std::span(truth.cells).subspan(row * width, width), std::back_inserter(pgm), grey_of);
    }
    return pgm;
}

std::string ground_truth_yaml(const GroundTruthGrid& truth, std::string_view image) {
    return ros_yaml(image, truth.cell_size, truth.i_begin * truth.cell_size, truth.j_begin * truth.cell_size);
}

FloorPlan floor_plan_of(const GroundTruthGrid& truth) {
    FloorPlan plan(truth.cell_size,
                   {truth.i_begin, truth.j_begin, truth.i_begin + truth.width, truth.j_begin + truth.height});
    for (std::int32_t y = 0; y < truth.height; ++y) {
        for (std::int32_t x = 0; x < truth.width; ++x) {
            if (truth.at(truth.i_begin + x, truth.j_begin + y) == GroundTruth::kFree) plan.free.set({x, y});
        }
    }
    return plan;
}

} // namespace scanloom::sim
