#pragma once

#include "common/scan/beam_angles.hpp"
#include "tests/support/angles.hpp"

#include <cmath>
#include <random>
#include <string>

/// Beam angles of every kind of real sensor, and of some that do not exist.
namespace scanloom::testing_support {

inline constexpr unsigned kAngleShapes = 13;

/// Pre: shape < kAngleShapes. Sets `name` to the name of the shape.
inline BeamAngles random_angles(std::mt19937& random, unsigned shape, std::string& name) {
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    const auto below = [&](unsigned n) { return static_cast<unsigned>(random() % n); };
    switch (shape) {
    case 0: name = "half-turn scanner"; return UniformAngles{-kPi / 2, kPi / 180, 180};
    case 1: name = "full turn"; return UniformAngles{-kPi, 2 * kPi / 120, 120};
    case 2: name = "full turn, first direction repeated"; return UniformAngles{0.0, 2 * kPi / 90, 91};
    case 3: name = "clockwise"; return UniformAngles{kPi, -2 * kPi / 100, 100};
    case 4: name = "sparse ring"; return UniformAngles{uniform(-4.0, 4.0), 2 * kPi / 16, 16};
    case 5: name = "few wide beams"; return UniformAngles{uniform(-4.0, 4.0), kPi / 2, 2 + below(3)};
    case 6: name = "one beam"; return UniformAngles{uniform(-4.0, 4.0), 1.0, 1};
    case 7: name = "two opposite beams"; return UniformAngles{uniform(-4.0, 4.0), kPi, 2};
    case 8: name = "270 degrees"; return UniformAngles{-0.75 * kPi, 1.5 * kPi / 200, 201};
    case 9: {
        name = "projected through a tangent";
        ExplicitAngles list;
        for (int i = -60; i <= 60; ++i) list.push_back(std::atan(i / 60.0 * std::tan(kPi / 3)));
        return list;
    }
    case 10: {
        name = "a turn in steps, with holes";
        SteppedAngles stepped{2 * kPi / 396'000, {}};
        for (std::int32_t step = static_cast<std::int32_t>(below(900)); step < 396'000;) {
            stepped.steps.push_back(step);
            const unsigned kind = below(40); // gaps of less and of more than four times the usual gap
            step += static_cast<std::int32_t>(kind == 0 ? 13'001 : kind == 1 ? 9'001 : 2600 + below(300));
        }
        return stepped;
    }
    case 11: name = "full turn of a float32 increment"; return UniformAngles{0.0, 0.017501922324299812, 360};
    default: {
        name = "any angles in any order";
        ExplicitAngles list(1 + below(150));
        for (double& angle : list) angle = uniform(-6.0, 6.0);
        return list;
    }
    }
}

} // namespace scanloom::testing_support
