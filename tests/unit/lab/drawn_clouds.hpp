#pragma once

#include "lab/landmark_comparison.hpp"

#include <vector>

namespace scanloom::lab {

/// Returns eleven points per place, 4 cm apart along x and centred at the place.
inline std::vector<Point2> bars(const std::vector<Point2>& places) {
    std::vector<Point2> points;
    for (const Point2& place : places) {
        for (int n = -5; n <= 5; ++n) points.push_back(place + Point2{0.04 * n, 0.0});
    }
    return points;
}

/// Returns one landmark per place; the places are more than 2 m apart.
inline SeenLandmarks seen_bars(const std::vector<Point2>& places) { return see_landmarks(bars(places)).value(); }

} // namespace scanloom::lab
