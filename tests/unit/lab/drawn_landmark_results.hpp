#pragma once

#include "lab/landmark_experiment.hpp"

#include "tests/unit/lab/drawn_clouds.hpp"

namespace scanloom::lab {

/// Returns a comparison in which 4 of 8 landmarks match, 3 of them within half the tolerance.
inline Comparison drawn_comparison() {
    Comparison comparison;
    comparison.metrics = {4, 0.5, 0.75, 0.02, 0.013};
    comparison.only_first = 4;
    comparison.only_second = 2;
    comparison.continuity = {0.8, 0.3, 1.0};
    return comparison;
}

/// Returns results with one place, one neighbour, one row in each sweep, and a recording.
inline LandmarkResults drawn_landmark_results() {
    LandmarkResults results;
    results.seed = 7;
    Comparison control = drawn_comparison();
    control.metrics.persistence = 1.0;
    results.places.push_back({{1.5, -2.0, 0.0}, {seen_bars({}), seen_bars({}), drawn_comparison(), "p.png"}, control});
    NeighbourResult neighbour;
    neighbour.to = 1;
    neighbour.comparison = drawn_comparison();
    neighbour.comparison.metrics.persistence = 0.25;
    results.neighbours.push_back(neighbour);
    results.tolerances.push_back({0.1, drawn_comparison().metrics});
    results.readings.push_back({50, 18000, 9, 0.15, 74941, 1166716, 6.5});
    results.windows.push_back({1, {0.0, 0.0, std::nullopt}, 0.015, 0.018});
    results.recorded = RecordedResult{"c.bin",
                                      "0 damaged packets",
                                      9,
                                      seen_bars({{0.0, 0.0}}),
                                      {seen_bars({}), seen_bars({}), drawn_comparison(), "r.png"}};
    return results;
}

} // namespace scanloom::lab
