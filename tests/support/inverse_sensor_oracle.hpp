#pragma once

#include "common/geometry/pose2.hpp"

#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

/// The inverse sensor model as a naive double loop over cells and beams, written from its definition
/// (Thrun, Burgard, Fox, Probabilistic Robotics, Table 9.2) and from nothing of the production code.
namespace scanloom::oracle {

struct Scene {
    std::vector<double> beam_angles; // radians, sensor frame, any order and turn
    std::vector<double> readings;    // metres; NaN = invalid, infinity = no return
    double range_min = 0.0;
    double range_max = 0.0;
    double alpha = 0.1;
    double beta = 0.0174533; // already at least the beam spacing
    double cell_size = 0.05;
    Pose2 T_map_sensor;
};

enum class Verdict { kNothing, kFree, kOccupied };

/// Angle between two directions in [-pi, pi], the short way round.
inline double turn_between(double a, double b) {
    const double d = std::abs(a - b);
    return d > std::numbers::pi ? 2.0 * std::numbers::pi - d : d;
}

struct Nearest {
    std::size_t beam = 0;
    double distance = 1e9; // radians
};

inline Nearest nearest_beam(const Scene& scene, double phi) {
    Nearest nearest;
    phi = std::remainder(phi, 2.0 * std::numbers::pi);
    for (std::size_t b = 0; b < scene.beam_angles.size(); ++b) {
        const double d = turn_between(phi, std::remainder(scene.beam_angles[b], 2.0 * std::numbers::pi));
        if (d < nearest.distance - 1e-12) nearest = {b, d}; // a tie, up to rounding: the lower index
    }
    return nearest;
}

inline Verdict verdict_at(const Scene& scene, double r, const Nearest& nearest) {
    const double alpha = std::max(scene.alpha, scene.cell_size);
    const double z = scene.readings[nearest.beam];
    if (std::isnan(z) || z <= 0.0 || z < scene.range_min) return Verdict::kNothing;
    if (r > std::min(scene.range_max, z + alpha / 2.0) || nearest.distance > scene.beta / 2.0) return Verdict::kNothing;
    if (z < scene.range_max && std::abs(r - z) < alpha / 2.0) return Verdict::kOccupied;
    if (r <= z) return Verdict::kFree;
    return Verdict::kNothing;
}

/// Verdict for a cell; none where moving r or phi by 2e-5 would change it.
inline std::optional<Verdict> verdict_of_cell(const Scene& scene, int i, int j) {
    const double x = (i + 0.5) * scene.cell_size - scene.T_map_sensor.x;
    const double y = (j + 0.5) * scene.cell_size - scene.T_map_sensor.y;
    const double r = std::hypot(x, y);
    const double phi = std::atan2(y, x) - scene.T_map_sensor.yaw;
    const double step = 2e-5;
    if (r < step) return std::nullopt; // a centre on the sensor itself has no direction
    if (r > scene.range_max + step) return Verdict::kNothing;
    const Verdict verdict = verdict_at(scene, r, nearest_beam(scene, phi));
    for (const double dphi : {-step, 0.0, step}) {
        const Nearest nearest = nearest_beam(scene, phi + dphi);
        for (const double dr : {-step, 0.0, step}) {
            if (verdict_at(scene, r + dr, nearest) != verdict) return std::nullopt;
        }
    }
    return verdict;
}

} // namespace scanloom::oracle
