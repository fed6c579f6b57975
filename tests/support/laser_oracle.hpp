#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"
#include "core/mapping/snapshot.hpp"
#include "tests/support/beam_index.hpp"
#include "tests/support/plane.hpp"
#include "tests/support/ray_oracle.hpp"
#include "tests/support/snapshot_cells.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

/// Computes the layers made from lasers by their definitions: the verdicts of each scan on every cell, added up in
/// integers.
namespace scanloom::oracle {

inline double metres_of(RangeMm mm) {
    return mm == kInvalidRange ? NAN : mm == kNoReturn ? HUGE_VAL : static_cast<double>(mm) / 1000.0;
}

/// Returns a scan as input of the inverse sensor model, with a band of width `alpha` and beams of width `beta`.
inline Scene scene_of(const mapping::MapConfig& config, const Sensor& sensor, const Scan& scan, double alpha,
                      double beta) {
    const BeamAngles angles = angles_of(scan, sensor);
    Scene scene{.explicit_angles = !std::holds_alternative<UniformAngles>(angles),
                .range_min = sensor.range_min,
                .range_max = sensor.range_max,
                .alpha = alpha,
                .aperture = sensor.aperture > 0.0 ? sensor.aperture : beta,
                .cell_size = config.cell_size,
                .T_map_sensor = compose(*scan.pose, sensor.mount)};
    for (std::size_t b = 0; b < scan.ranges.size(); ++b) {
        scene.beam_angles.push_back(beam_angle(angles, b));
        const double z = metres_of(scan.ranges[b]);
        scene.readings.push_back(config.drop_no_return && z >= sensor.range_max ? NAN : z);
    }
    scene.sight = sight_of(scene);
    return scene;
}

/// Returns the verdicts of the inverse sensor model on every cell that a scan can change.
inline Opinions opinions_of(const Scene& scene) {
    double farthest = 0.0;
    for (const double z : scene.readings) {
        if (!std::isnan(z)) farthest = std::max(farthest, std::min(z, scene.range_max));
    }
    const double reach = farthest + std::max(scene.alpha, scene.cell_size);
    const auto index = [&](double metres) { return static_cast<int>(std::floor(metres / scene.cell_size)); };
    const auto& at = scene.T_map_sensor;
    const BeamIndex beams(scene);
    Opinions opinions;
    for (int j = index(at.y - reach) - 1; j <= index(at.y + reach) + 1; ++j) {
        for (int i = index(at.x - reach) - 1; i <= index(at.x + reach) + 1; ++i) {
            const double x = (i + 0.5) * scene.cell_size - at.x;
            const double y = (j + 0.5) * scene.cell_size - at.y;
            if (x * x + y * y > (reach + kStep) * (reach + kStep)) continue;
            const auto verdict = verdict_of_cell(scene, i, j, beams);
            if (!verdict) {
                opinions.push_back({{i, j}, kMayBeAnything});
            } else if (*verdict != Verdict::kNothing) {
                opinions.push_back({{i, j}, *verdict == Verdict::kFree ? kMayBeFree : kMayBeOccupied});
            }
        }
    }
    return opinions;
}

/// Integrates laser scans cell by cell. After a verdict on a cell that was not firm, the cell is excluded from the
/// comparison.
class LaserOracle {
public:
    explicit LaserOracle(const mapping::MapConfig& config)
        : config_(config), prior_(fixed(config.p_prior)), l_min_(fixed(config.p_min)), l_max_(fixed(config.p_max)) {}

    void add(const Sensor& sensor, const Scan& scan) {
        const auto& c = config_;
        if (c.ray_model == RayModel::kInverseSensorModel) {
            add_to_occupancy(opinions_of(scene_of(c, sensor, scan, c.obstacle_thickness, c.beam_aperture)));
        } else {
            auto beams = opinions_of_beams(ray_scene_of(sensor, scan));
            if (!c.accumulate) beams = {once_a_scan(beams)};
            for (const auto& opinions : beams) add_to_occupancy(opinions);
        }
        for (const auto& [cell, may_be] :
             opinions_of(scene_of(c, sensor, scan, c.himm_obstacle_thickness, c.himm_beam_aperture))) {
            count(himm_[cell], may_be);
        }
    }

    /// Compares every firm cell of both layers. Adds to `firm` the number of compared cells that any scan changed.
    void expect_equal(const mapping::Snapshot& snapshot, const std::string& what, std::size_t& firm) const {
        std::size_t wrong = 0;
        const auto compare = [&](const Plane<Cell>& plane, int unknown, const char* layer, auto&& shown_at) {
            plane.for_each(2, [&](grid::Cell at, const Cell& cell) {
                if (cell.is_doubtful) return;
                const int expected = cell.is_known ? cell.value : unknown;
                firm += cell.is_known;
                if (shown_at(at) == expected || ++wrong > 5) return;
                ADD_FAILURE() << what << ": " << layer << " of cell " << at.i << ", " << at.j << " is " << shown_at(at)
                              << ", not " << expected << ", after entry " << snapshot.revision;
            });
        };
        compare(occupancy_, mapping::kUnknownLogOdds, "occupancy",
                [&](grid::Cell at) { return int{testing_support::occupancy_at(snapshot, at)}; });
        compare(himm_, mapping::kUnseenHimm, "himm",
                [&](grid::Cell at) { return int{testing_support::himm_at(snapshot, at)}; });
        testing_support::for_each_laser_cell(
            snapshot, [&](grid::Cell at, const mapping::LaserChunk& chunk, std::size_t n) {
                wrong += chunk.occupancy[n] != mapping::kUnknownLogOdds && occupancy_.at(at).is_untouched();
                wrong += chunk.himm[n] != mapping::kUnseenHimm && himm_.at(at).is_untouched();
            });
        ASSERT_EQ(wrong, 0U) << what;
    }

private:
    struct Cell {
        int value = 0;
        bool is_known = false;
        bool is_doubtful = false;

        [[nodiscard]] bool is_untouched() const { return !is_known && !is_doubtful; }
    };

    /// Converts a probability to natural log-odds in steps of 1/2048.
    [[nodiscard]] static int fixed(double p) { return static_cast<int>(std::lround(2048.0 * std::log(p / (1.0 - p)))); }

    [[nodiscard]] RayScene ray_scene_of(const Sensor& sensor, const Scan& scan) const {
        RayScene scene{.model = config_.ray_model,
                       .hit_radius = config_.hit_radius,
                       .cell_size = config_.cell_size,
                       .T_map_sensor = compose(*scan.pose, sensor.mount)};
        const BeamAngles angles = angles_of(scan, sensor);
        for (std::size_t b = 0; b < scan.ranges.size(); ++b) {
            const double z = metres_of(scan.ranges[b]);
            if (std::isnan(z) || z < sensor.range_min) continue;
            if (z >= sensor.range_max && config_.drop_no_return) continue;
            scene.beams.push_back({beam_angle(angles, b), std::min(z, sensor.range_max), z < sensor.range_max});
        }
        return scene;
    }

    /// l = clamp(l + model(cell) - l0, l_min, l_max).
    void add_to_occupancy(const Opinions& opinions) {
        for (const auto& [at, may_be] : opinions) {
            Cell& cell = occupancy_[at];
            if (!is_firm(may_be)) {
                cell.is_doubtful = true;
                continue;
            }
            const int model = fixed(may_be == kMayBeOccupied ? config_.p_occupied : config_.p_free);
            const int before = cell.is_known ? cell.value : prior_;
            cell = {std::clamp(before + model - prior_, l_min_, l_max_), true, cell.is_doubtful};
        }
    }

    /// Adds 3 for a hit and subtracts 1 for a cell before the hit, clamped to 0..15.
    void count(Cell& cell, MayBe may_be) const {
        if (!is_firm(may_be)) {
            cell.is_doubtful = true;
            return;
        }
        const int step = may_be == kMayBeOccupied ? config_.himm_increment : -config_.himm_decrement;
        cell = {std::clamp(cell.value + step, 0, 15), true, cell.is_doubtful};
    }

    mapping::MapConfig config_;
    int prior_;
    int l_min_;
    int l_max_;
    Plane<Cell> occupancy_{Cell{}};
    Plane<Cell> himm_{Cell{}};
};

} // namespace scanloom::oracle
