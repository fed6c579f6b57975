#pragma once

#include "common/geometry/pose2.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

/// The inverse sensor model as a naive double loop over cells and beams, written from its definition (Thrun, Burgard,
/// Fox, Probabilistic Robotics, Table 9.2) without the production code.
namespace scanloom::oracle {

/// How the beams divide the directions among them. Uniform beams are one increment apart. A list of angles may have
/// wider gaps and still be without blind gaps, up to four times the median of all gaps except the widest.
struct Sight {
    double beta = 0.0;    // full width of a beam
    double gap_max = 0.0; // wider gaps between beams are not observed
};

struct Scene {
    std::vector<double> beam_angles; // radians, sensor frame, any order and turn
    bool explicit_angles = false;    // a list of angles, which may be uneven
    std::vector<double> readings;    // metres; NaN = invalid, infinity = no return
    double range_min = 0.0;
    double range_max = 0.0;
    double alpha = 0.1;
    double aperture = 0.0174533;
    double cell_size = 0.05;
    Pose2 T_map_sensor;
    Sight sight; // sight_of() the members above
};

enum class Verdict { kNothing, kFree, kOccupied };

/// Returns the smaller angle between two directions in [-pi, pi].
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

/// The counter-clockwise turn from a to b, in [0, 2 pi).
inline double turn_to(double a, double b) {
    const double d = std::fmod(b - a, 2.0 * std::numbers::pi);
    return d < 0.0 ? d + 2.0 * std::numbers::pi : d;
}

/// Returns the turn from each beam to the next beam with a different direction.
inline std::vector<double> gaps_between_beams(const Scene& scene) {
    std::vector<double> gaps;
    for (std::size_t a = 0; a < scene.beam_angles.size(); ++a) {
        double gap = 2.0 * std::numbers::pi;
        bool first_of_its_direction = true;
        for (std::size_t b = 0; b < scene.beam_angles.size(); ++b) {
            const double turn = turn_to(scene.beam_angles[a], scene.beam_angles[b]);
            const bool same = turn < 1e-9 || turn > 2.0 * std::numbers::pi - 1e-9;
            if (same && b < a) first_of_its_direction = false;
            if (!same) gap = std::min(gap, turn);
        }
        if (first_of_its_direction) gaps.push_back(gap);
    }
    return gaps;
}

inline Sight sight_of(const Scene& scene) {
    auto gaps = gaps_between_beams(scene);
    if (scene.beam_angles.size() < 2 || gaps.size() < 2) return {scene.aperture, 0.0};
    if (!scene.explicit_angles) {
        const double increment = std::abs(scene.beam_angles[1] - scene.beam_angles[0]);
        return {std::max(scene.aperture, increment), 0.0};
    }
    std::sort(gaps.begin(), gaps.end());
    gaps.pop_back();
    const double median = gaps[(gaps.size() - 1) / 2];
    return {std::max(scene.aperture, median), 4.0 * median};
}

/// Returns the gap between the two beams on either side of a direction.
inline double gap_around(const Scene& scene, double phi) {
    double ahead = 2.0 * std::numbers::pi;
    double behind = 2.0 * std::numbers::pi;
    for (const double angle : scene.beam_angles) {
        ahead = std::min(ahead, turn_to(phi, angle));
        behind = std::min(behind, turn_to(angle, phi));
    }
    return ahead + behind;
}

/// The beam that faces a direction, and whether it observes that direction.
struct Sighting {
    std::size_t beam = 0;
    bool is_seen = false;
};

inline Sighting sighting_at(const Scene& scene, double phi) {
    const Nearest nearest = nearest_beam(scene, phi);
    const auto& sight = scene.sight;
    const bool in_a_small_gap = sight.gap_max > 0.0 && gap_around(scene, phi) <= sight.gap_max;
    return {nearest.beam, nearest.distance <= sight.beta / 2.0 || in_a_small_gap};
}

inline Verdict verdict_at(const Scene& scene, double r, Sighting sighting) {
    const double alpha = std::max(scene.alpha, scene.cell_size);
    const double z = scene.readings[sighting.beam];
    if (std::isnan(z) || z <= 0.0 || z < scene.range_min) return Verdict::kNothing;
    if (r > std::min(scene.range_max, z + alpha / 2.0) || !sighting.is_seen) return Verdict::kNothing;
    if (z < scene.range_max && std::abs(r - z) < alpha / 2.0) return Verdict::kOccupied;
    if (r <= z) return Verdict::kFree;
    return Verdict::kNothing;
}

/// Changes of r (metres) and phi (radians) that must not change a firm verdict.
inline constexpr double kStep = 2e-5;

/// Returns the verdict for a cell, or nullopt if moving r or phi by 2e-5 would change it. `sighting_of` is
/// sighting_at() or a function with the same results.
template <class SightingOf>
std::optional<Verdict> verdict_of_cell(const Scene& scene, int i, int j, SightingOf&& sighting_of) {
    const double x = (i + 0.5) * scene.cell_size - scene.T_map_sensor.x;
    const double y = (j + 0.5) * scene.cell_size - scene.T_map_sensor.y;
    const double r = std::hypot(x, y);
    const double phi = std::atan2(y, x) - scene.T_map_sensor.yaw;
    if (r < kStep) return std::nullopt; // a cell centre at the sensor has no direction
    if (r > scene.range_max + kStep) return Verdict::kNothing;
    const Verdict verdict = verdict_at(scene, r, sighting_of(phi));
    for (const double dphi : {-kStep, 0.0, kStep}) {
        const Sighting sighting = sighting_of(phi + dphi);
        for (const double dr : {-kStep, 0.0, kStep}) {
            if (verdict_at(scene, r + dr, sighting) != verdict) return std::nullopt;
        }
    }
    return verdict;
}

inline std::optional<Verdict> verdict_of_cell(const Scene& scene, int i, int j) {
    return verdict_of_cell(scene, i, j, [&](double phi) { return sighting_at(scene, phi); });
}

} // namespace scanloom::oracle
