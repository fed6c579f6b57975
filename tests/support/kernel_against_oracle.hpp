#pragma once

#include "common/scan/scan.hpp"
#include "core/grid/cell.hpp"
#include "core/mapping/sweep/sweep.hpp"
#include "tests/support/beam_index.hpp"
#include "tests/support/inverse_sensor_oracle.hpp"
#include "tests/support/plane.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

/// Compares the production sensor model with the oracle, cell by cell.
namespace scanloom::mapping {

/// One scan and all inputs of the model.
struct Case {
    std::string shape;
    BeamAngles angles;
    double aperture = std::numbers::pi / 180.0;
    double range_min = 0.0;
    double range_max = 3.0;
    bool drop_no_return = false;
    double thickness = 0.1;
    double cell_size = 0.05;
    Pose2 T_map_sensor;
    std::vector<RangeMm> ranges;
};

using Verdicts = oracle::Plane<oracle::Verdict>;

inline void add_verdicts(const Case& c, grid::ChunkKey key, const grid::BitPlane& cells, oracle::Verdict verdict,
                         Verdicts& verdicts) {
    for (int j = 0; j < grid::kChunkSide; ++j) {
        for (int i = 0; i < grid::kChunkSide; ++i) {
            if (!grid::is_set(cells, {i, j})) continue;
            const grid::Cell cell{key.ci * grid::kChunkSide + i, key.cj * grid::kChunkSide + j};
            oracle::Verdict& written = verdicts[cell];
            if (written != oracle::Verdict::kNothing) {
                ADD_FAILURE() << c.shape << ": cell " << cell.i << ", " << cell.j << " changes twice in one scan";
            }
            written = verdict;
        }
    }
}

/// Returns the verdicts of the production kernel. Fails the test if the kernel visits a cell twice.
inline Verdicts run_kernel(const Case& c) {
    Verdicts verdicts{oracle::Verdict::kNothing};
    const auto ring = make_fan_ring(make_beam_fan(c.angles, c.aperture));
    const Sweep::Band band{&ring, c.thickness};
    Sweep sweep({c.ranges, c.T_map_sensor, {c.range_min, c.range_max, c.drop_no_return}, c.cell_size}, {&band, 1});
    for (std::size_t strip = 0; strip < sweep.strips(); ++strip) {
        sweep.visit(strip, [&](grid::ChunkKey key, std::span<const ChunkVerdicts> of_bands) {
            add_verdicts(c, key, of_bands.front().free, oracle::Verdict::kFree, verdicts);
            add_verdicts(c, key, of_bands.front().occupied, oracle::Verdict::kOccupied, verdicts);
        });
    }
    return verdicts;
}

/// Returns the cells with a verdict, row by row.
inline std::vector<std::pair<grid::Cell, oracle::Verdict>> changed_cells(const Verdicts& verdicts) {
    std::vector<std::pair<grid::Cell, oracle::Verdict>> cells;
    verdicts.for_each(0, [&](grid::Cell cell, oracle::Verdict verdict) {
        if (verdict != oracle::Verdict::kNothing) cells.emplace_back(cell, verdict);
    });
    return cells;
}

inline oracle::Scene scene_of(const Case& c) {
    oracle::Scene scene{.explicit_angles = !std::holds_alternative<UniformAngles>(c.angles),
                        .range_min = c.range_min,
                        .range_max = c.range_max,
                        .alpha = c.thickness,
                        .aperture = c.aperture,
                        .cell_size = c.cell_size,
                        .T_map_sensor = c.T_map_sensor};
    for (std::size_t b = 0; b < beam_count(c.angles); ++b) {
        scene.beam_angles.push_back(beam_angle(c.angles, b));
        const RangeMm mm = c.ranges[b];
        const bool is_dropped = c.drop_no_return && mm / 1000.0 >= c.range_max;
        scene.readings.push_back(mm == kInvalidRange || is_dropped ? NAN : mm == kNoReturn ? HUGE_VAL : mm / 1000.0);
    }
    scene.sight = oracle::sight_of(scene);
    return scene;
}

/// Returns the greatest distance at which a scan can change a cell: its longest reading, or its maximum range if a beam
/// returned nothing.
inline double reach_of(const Case& c) {
    double reach = 0.0;
    for (const RangeMm mm : c.ranges) {
        if (mm != kInvalidRange) reach = std::max(reach, std::min(c.range_max, mm / 1000.0));
    }
    return reach + std::max(c.thickness, c.cell_size);
}

/// The beams that the oracle examines for each cell: every beam, or, for large scans, those that an index finds.
enum class Beams { kEach, kIndexed };

/// Compares every cell around the sensor; counts the cells compared in `firm`.
inline void expect_equal_to_oracle(const Case& c, std::size_t& firm, Beams beams = Beams::kEach) {
    const auto kernel = run_kernel(c);
    const auto scene = scene_of(c);
    const oracle::BeamIndex index(scene);
    const auto index_of = [&](double metres) { return static_cast<std::int32_t>(std::floor(metres / c.cell_size)); };
    const grid::Cell centre{index_of(c.T_map_sensor.x), index_of(c.T_map_sensor.y)};
    const int reach = static_cast<int>(std::ceil(reach_of(c) / c.cell_size)) + 2;
    for (const auto& [cell, verdict] : changed_cells(kernel)) {
        if (std::max(std::abs(cell.i - centre.i), std::abs(cell.j - centre.j)) > reach) {
            ADD_FAILURE() << c.shape << ": cell " << cell.i << ", " << cell.j << " is beyond the reach of the scan";
        }
    }
    for (int j = centre.j - reach; j <= centre.j + reach; ++j) {
        for (int i = centre.i - reach; i <= centre.i + reach; ++i) {
            const auto expected = beams == Beams::kEach ? oracle::verdict_of_cell(scene, i, j)
                                                        : oracle::verdict_of_cell(scene, i, j, index);
            if (!expected) continue;
            const auto got = kernel.at({i, j});
            ++firm;
            if (got == *expected) continue; // millions of assertions would take longer than the comparison
            FAIL() << c.shape << ": " << static_cast<int>(got) << ", not " << static_cast<int>(*expected) << ": cell "
                   << i << ", " << j << ", sensor at " << c.T_map_sensor.x << ", " << c.T_map_sensor.y << ", yaw "
                   << c.T_map_sensor.yaw << ", " << beam_count(c.angles) << " beams";
        }
    }
}

} // namespace scanloom::mapping
