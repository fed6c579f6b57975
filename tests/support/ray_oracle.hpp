#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/session_options.hpp"
#include "core/grid/cell.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <utility>
#include <vector>

/// The models that trace rays, computed by geometry: the verdict of each beam on every cell around it, cell by cell.
namespace scanloom::oracle {

/// All verdicts that a beam or a scan may have on a cell when its points move by 2e-5 m. Firm if there is only one.
using MayBe = unsigned;
inline constexpr MayBe kMayBeNothing = 1;
inline constexpr MayBe kMayBeFree = 2;
inline constexpr MayBe kMayBeOccupied = 4;
inline constexpr MayBe kMayBeAnything = 7;

inline bool is_firm(MayBe may_be) {
    return may_be == kMayBeNothing || may_be == kMayBeFree || may_be == kMayBeOccupied;
}

/// The cells with any verdict, each once.
using Opinions = std::vector<std::pair<grid::Cell, MayBe>>;

struct RayBeam {
    double angle = 0.0;  // radians, sensor frame
    double metres = 0.0; // the length of the observed ray
    bool is_hit = false; // the ray ends at a hit
};

struct RayScene {
    RayModel model = RayModel::kBresenham;
    double hit_radius = 0.0;
    double cell_size = 0.05;
    Pose2 T_map_sensor;
    std::vector<RayBeam> beams; // the beams with a valid reading, in their order
};

inline constexpr double kPointMoves = 2e-5; // metres

/// cell = floor(coordinate * cells_per_metre).
inline grid::Cell cell_of(double x, double y, double cell_size) {
    const double cells_per_metre = 1.0 / cell_size;
    return {static_cast<std::int32_t>(std::floor(x * cells_per_metre)),
            static_cast<std::int32_t>(std::floor(y * cells_per_metre))};
}

/// Returns the cells that may contain a point.
inline std::vector<grid::Cell> cells_near(double x, double y, double cell_size) {
    std::vector<grid::Cell> cells;
    for (const double dx : {-kPointMoves, kPointMoves}) {
        for (const double dy : {-kPointMoves, kPointMoves}) {
            const grid::Cell cell = cell_of(x + dx, y + dy, cell_size);
            if (std::find(cells.begin(), cells.end(), cell) == cells.end()) cells.push_back(cell);
        }
    }
    return cells;
}

/// Returns, for each step along the longer axis, the cell whose centre is nearest to the line between the centres of
/// the two cells. Of two equally near cells, the one further along the shorter axis.
inline std::vector<grid::Cell> line_of_cells(grid::Cell from, grid::Cell to) {
    const std::int64_t di = to.i - from.i;
    const std::int64_t dj = to.j - from.j;
    const bool is_flat = std::abs(di) >= std::abs(dj);
    const std::int64_t longer = std::max(std::abs(di), std::abs(dj));
    const std::int64_t shorter = std::min(std::abs(di), std::abs(dj));
    std::vector<grid::Cell> cells;
    for (std::int64_t n = 0; n <= longer; ++n) {
        std::int64_t nearest = 0; // distance of (n, m) from the line: |n shorter - m longer|, times a constant
        for (std::int64_t m = 1; m <= shorter; ++m) {
            if (std::abs(n * shorter - m * longer) <= std::abs(n * shorter - nearest * longer)) nearest = m;
        }
        const std::int64_t i = is_flat ? n : nearest;
        const std::int64_t j = is_flat ? nearest : n;
        cells.push_back({static_cast<std::int32_t>(from.i + (di < 0 ? -i : i)),
                         static_cast<std::int32_t>(from.j + (dj < 0 ? -j : j))});
    }
    return cells;
}

/// Returns whether any part of a segment lies in a square grown by `grown` on every side. Clips the segment by the four
/// edges.
inline bool meets(Point2 from, Point2 to, grid::Cell cell, double cell_size, double grown) {
    double enters = 0.0;
    double leaves = 1.0;
    for (int axis = 0; axis < 2; ++axis) {
        const double low = (axis == 0 ? cell.i : cell.j) * cell_size - grown;
        const double high = low + cell_size + 2.0 * grown;
        const double start = axis == 0 ? from.x : from.y;
        const double length = (axis == 0 ? to.x : to.y) - start;
        if (length == 0.0) {
            if (start < low || start > high) return false;
            continue;
        }
        const double a = (low - start) / length;
        const double b = (high - start) / length;
        enters = std::max(enters, std::min(a, b));
        leaves = std::min(leaves, std::max(a, b));
        if (enters > leaves) return false;
    }
    return true;
}

using OpinionMap = std::map<std::pair<std::int32_t, std::int32_t>, MayBe>; // by row and column

/// Traces Bresenham's line to each cell that may contain the end.
inline OpinionMap bresenham_opinions(const RayScene& scene, const RayBeam& beam, Point2 end) {
    const grid::Cell start = cell_of(scene.T_map_sensor.x, scene.T_map_sensor.y, scene.cell_size);
    const auto ends = cells_near(end.x, end.y, scene.cell_size);
    std::map<std::pair<std::int32_t, std::int32_t>, std::pair<MayBe, std::size_t>> said; // number of lines
    for (const auto& last : ends) {
        for (const auto& cell : line_of_cells(start, last)) {
            auto& [may_be, lines] = said[{cell.j, cell.i}];
            may_be |= beam.is_hit && cell == last ? kMayBeOccupied : kMayBeFree;
            ++lines;
        }
    }
    OpinionMap opinions;
    for (const auto& [at, by] : said) opinions[at] = by.first | (by.second < ends.size() ? kMayBeNothing : 0U);
    return opinions;
}

/// Returns every square that the segment crosses.
inline OpinionMap traversal_opinions(const RayScene& scene, const RayBeam& beam, Point2 end) {
    const Point2 from{scene.T_map_sensor.x, scene.T_map_sensor.y};
    const grid::Cell start = cell_of(from.x, from.y, scene.cell_size);
    const auto ends = cells_near(end.x, end.y, scene.cell_size);
    const auto last = cell_of(end.x, end.y, scene.cell_size);
    const MayBe at_end = beam.is_hit ? kMayBeOccupied : kMayBeFree;
    OpinionMap opinions;
    for (std::int32_t j = std::min(start.j, last.j) - 1; j <= std::max(start.j, last.j) + 1; ++j) {
        for (std::int32_t i = std::min(start.i, last.i) - 1; i <= std::max(start.i, last.i) + 1; ++i) {
            const grid::Cell cell{i, j};
            const bool surely = cell == start || meets(from, end, cell, scene.cell_size, -kPointMoves);
            if (!surely && !meets(from, end, cell, scene.cell_size, kPointMoves)) continue;
            MayBe may_be = surely ? kMayBeFree : kMayBeFree | kMayBeNothing;
            if (std::find(ends.begin(), ends.end(), cell) != ends.end()) {
                may_be = ends.size() == 1 ? at_end : may_be | at_end;
            }
            opinions[{j, i}] = may_be;
        }
    }
    return opinions;
}

/// Marks the cells whose centres are within hit_radius of the hit as hit.
inline void add_hit_radius(const RayScene& scene, Point2 hit, OpinionMap& opinions) {
    const auto reach = static_cast<std::int32_t>(std::ceil(scene.hit_radius / scene.cell_size)) + 1;
    const grid::Cell middle = cell_of(hit.x, hit.y, scene.cell_size);
    for (std::int32_t j = middle.j - reach; j <= middle.j + reach; ++j) {
        for (std::int32_t i = middle.i - reach; i <= middle.i + reach; ++i) {
            const double distance =
                std::hypot((i + 0.5) * scene.cell_size - hit.x, (j + 0.5) * scene.cell_size - hit.y);
            if (distance > scene.hit_radius + kPointMoves) continue;
            auto& may_be = opinions.try_emplace({j, i}, kMayBeNothing).first->second;
            may_be = distance <= scene.hit_radius - kPointMoves ? kMayBeOccupied : may_be | kMayBeOccupied;
        }
    }
}

/// Returns the verdicts of each beam, in the beams' order.
inline std::vector<Opinions> opinions_of_beams(const RayScene& scene) {
    std::vector<Opinions> all;
    for (const auto& beam : scene.beams) {
        const double direction = scene.T_map_sensor.yaw + beam.angle;
        const Point2 end{scene.T_map_sensor.x + beam.metres * std::cos(direction),
                         scene.T_map_sensor.y + beam.metres * std::sin(direction)};
        auto opinions = scene.model == RayModel::kTraversal ? traversal_opinions(scene, beam, end)
                                                            : bresenham_opinions(scene, beam, end);
        if (beam.is_hit && scene.hit_radius > 0.0) add_hit_radius(scene, end, opinions);
        auto& of_beam = all.emplace_back();
        for (const auto& [at, may_be] : opinions) of_beam.push_back({{at.second, at.first}, may_be});
    }
    return all;
}

/// Combines the beams' verdicts: each cell once per scan, a hit overrides a miss.
inline Opinions once_a_scan(const std::vector<Opinions>& beams) {
    struct Said {
        MayBe by_any = 0;
        bool surely_hit = false;
        bool surely_passed = false;
    };
    std::map<std::pair<std::int32_t, std::int32_t>, Said> said;
    for (const auto& beam : beams) {
        for (const auto& [cell, may_be] : beam) {
            auto& of_cell = said[{cell.j, cell.i}];
            of_cell.by_any |= may_be;
            of_cell.surely_hit |= may_be == kMayBeOccupied;
            of_cell.surely_passed |= may_be == kMayBeFree;
        }
    }
    Opinions opinions;
    for (const auto& [at, of_cell] : said) {
        const bool may_be_hit = (of_cell.by_any & kMayBeOccupied) != 0;
        const MayBe may_be = of_cell.surely_hit      ? kMayBeOccupied
                             : may_be_hit            ? kMayBeAnything
                             : of_cell.surely_passed ? kMayBeFree
                                                     : of_cell.by_any;
        opinions.push_back({{at.second, at.first}, may_be});
    }
    return opinions;
}

} // namespace scanloom::oracle
