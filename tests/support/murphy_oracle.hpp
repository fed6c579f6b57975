#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"
#include "core/mapping/snapshot.hpp"
#include "tests/support/plane.hpp"
#include "tests/support/snapshot_cells.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

/// Murphy's sonar model in probabilities, cell by cell and cone by cone.
/// Source  Murphy, Introduction to AI Robotics (2000), chapter 11.
namespace scanloom::oracle {

enum class Region { kNone, kObstacle, kFree };

struct Cone {
    double angle = 0.0;     // radians, sensor frame
    double reading = 0.0;   // metres; NaN = invalid, infinity = no return
    double half = 0.0;      // radians, half the aperture
    double alpha = 0.5;     // metres
    double range_min = 0.0; // metres
    double range_max = 0.0; // metres
};

inline Region region_at(const Cone& cone, double r, double a) {
    const double z = cone.reading;
    if (std::isnan(z) || z <= 0.0 || z < cone.range_min) return Region::kNone;
    if (r > std::min(cone.range_max, z + cone.alpha / 2.0) || a > cone.half) return Region::kNone;
    if (z < cone.range_max && std::abs(r - z) < cone.alpha / 2.0) return Region::kObstacle;
    return r <= z ? Region::kFree : Region::kNone;
}

inline double occupied_probability(const Cone& cone, Region region, double r, double a, double at_most) {
    const double R = cone.range_max;
    const double w = ((R - r) / R + (cone.half - a) / cone.half) / 2.0;
    return region == Region::kObstacle ? std::min(at_most, 0.5 + 0.5 * w) : 0.5 * (1.0 - w);
}

/// Returns p' = occ p / (occ p + (1 - occ) (1 - p)).
inline double product_rule(double occ, double p) { return occ * p / (occ * p + (1.0 - occ) * (1.0 - p)); }

/// Fuses sonar scans. Excludes cells whose region in a cone changes when r or the angle moves by 2e-5.
class MurphyOracle {
public:
    explicit MurphyOracle(const mapping::MapConfig& config) : config_(config) {}

    void add(const Sensor& sensor, const Scan& scan) {
        const BeamAngles angles = angles_of(scan, sensor);
        const double aperture = sensor.aperture > 0.0 ? sensor.aperture : config_.sonar_beam_aperture;
        for (std::size_t k = 0; k < scan.ranges.size(); ++k) {
            const RangeMm mm = scan.ranges[k];
            Cone cone{.angle = beam_angle(angles, k),
                      .reading = mm == kInvalidRange ? NAN
                                 : mm == kNoReturn   ? HUGE_VAL
                                                     : mm / 1000.0,
                      .half = aperture / 2.0,
                      .alpha = std::max(config_.sonar_obstacle_thickness, config_.cell_size),
                      .range_min = sensor.range_min,
                      .range_max = sensor.range_max};
            if (config_.drop_no_return && cone.reading >= cone.range_max) continue;
            add(cone, compose(*scan.pose, sensor.mount));
        }
    }

    /// The production code adds log-odds rounded to 1/2048 nat, which gives an error of at most half a step per update.
    /// The clamp adds no error except half a step at its limits. So after n updates a cell may differ by at most n /
    /// 4096 nat.
    void expect_near(const mapping::Snapshot& snapshot, const std::string& what, std::size_t& firm) const {
        std::size_t wrong = 0;
        cells_.for_each(2, [&](grid::Cell at, const Cell& cell) {
            if (cell.is_doubtful) return;
            const mapping::LogOdds shown = testing_support::sonar_at(snapshot, at);
            if (cell.updates == 0 || shown == mapping::kUnknownLogOdds) {
                wrong += (cell.updates == 0) != (shown == mapping::kUnknownLogOdds);
                return;
            }
            ++firm;
            const double expected = std::log(cell.p / (1.0 - cell.p));
            if (std::abs(shown / 2048.0 - expected) <= cell.updates / 4096.0 + 1e-7 || ++wrong > 5) return;
            ADD_FAILURE() << what << ": cell " << at.i << ", " << at.j << " is at " << shown / 2048.0 << " nat, not "
                          << expected << ", after " << cell.updates << " updates";
        });
        snapshot.sonar.visit({}, 0, [&](grid::ChunkKey key, const mapping::SonarChunk& chunk) {
            for (std::int32_t n = 0; n < 4096; ++n) {
                const Cell& cell = cells_.at({64 * key.ci + n % 64, 64 * key.cj + n / 64});
                const bool is_known = chunk.cells[static_cast<std::size_t>(n)] != mapping::kUnknownLogOdds;
                wrong += is_known && cell.updates == 0 && !cell.is_doubtful;
            }
        });
        ASSERT_EQ(wrong, 0U) << what;
    }

private:
    struct Cell {
        double p = 0.5;
        int updates = 0;
        bool is_doubtful = false;
    };

    void add(const Cone& cone, const Pose2& T_map_sensor) {
        const double size = config_.cell_size;
        const double reach = std::min(cone.range_max, cone.reading + cone.alpha); // NaN: contains no cell
        const auto index = [&](double metres) { return static_cast<std::int32_t>(std::floor(metres / size)); };
        if (!(reach > 0.0)) return;
        for (std::int32_t j = index(T_map_sensor.y - reach) - 1; j <= index(T_map_sensor.y + reach) + 1; ++j) {
            for (std::int32_t i = index(T_map_sensor.x - reach) - 1; i <= index(T_map_sensor.x + reach) + 1; ++i) {
                const double x = (i + 0.5) * size - T_map_sensor.x;
                const double y = (j + 0.5) * size - T_map_sensor.y;
                const double off = std::atan2(y, x) - T_map_sensor.yaw - cone.angle;
                add(cone, {i, j}, std::hypot(x, y), std::abs(std::remainder(off, 2.0 * std::numbers::pi)));
            }
        }
    }

    void add(const Cone& cone, grid::Cell at, double r, double a) {
        constexpr double kMoves = 2e-5; // metres, radians
        const Region region = region_at(cone, r, a);
        bool is_firm = r >= kMoves; // a cell centre at the sensor has no direction
        for (const double dr : {-kMoves, 0.0, kMoves}) {
            for (const double da : {-kMoves, 0.0, kMoves}) is_firm &= region_at(cone, r + dr, a + da) == region;
        }
        if (is_firm && region == Region::kNone) return;
        Cell& cell = cells_[at];
        cell.is_doubtful |= !is_firm;
        if (!is_firm) return;
        const double occ = occupied_probability(cone, region, r, a, config_.sonar_p_occupied_max);
        cell.p = std::clamp(product_rule(occ, cell.p), config_.sonar_p_min, config_.sonar_p_max);
        ++cell.updates;
    }

    mapping::MapConfig config_;
    Plane<Cell> cells_{Cell{}};
};

} // namespace scanloom::oracle
