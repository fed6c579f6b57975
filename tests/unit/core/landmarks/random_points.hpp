#pragma once

#include "common/geometry/pose2.hpp"
#include "tests/support/uniform.hpp"

#include <cstddef>
#include <random>
#include <vector>

/// Random clouds that depend only on the seed, on every machine.
namespace scanloom::testing_support {

/// Returns a cloud of one of several kinds: random points, a lattice (with many equal points and distances), a line, or
/// groups.
inline std::vector<Point2> random_points(std::mt19937& random, std::size_t count) {
    std::vector<Point2> points;
    const auto kind = random() % 5;
    const auto step = static_cast<int>(1 + random() % 8);
    const auto on_lattice = [&] { return static_cast<double>(static_cast<int>(random() % 8) - step) * 0.25; };
    for (std::size_t n = 0; n < count; ++n) {
        switch (kind) {
        case 0: points.push_back({uniform(random, -2.0, 2.0), uniform(random, -2.0, 2.0)}); break;
        case 1: points.push_back({on_lattice(), on_lattice()}); break;
        case 2: points.push_back({on_lattice(), 1.0}); break;
        case 3: {
            const Point2 heap{on_lattice(), on_lattice()};
            points.push_back(heap + Point2{uniform(random, -0.05, 0.05), uniform(random, -0.05, 0.05)});
            break;
        }
        default:
            if (points.empty() || random() % 3 == 0) {
                points.push_back({uniform(random, -2.0, 2.0), uniform(random, -2.0, 2.0)});
            } else {
                points.push_back(points[random() % points.size()]);
            }
        }
    }
    return points;
}

} // namespace scanloom::testing_support
