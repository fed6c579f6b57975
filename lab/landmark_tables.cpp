#include "lab/landmark_tables.hpp"

#include "lab/published_landmarks.hpp"

#include <fmt/format.h>

#include <numbers>

namespace scanloom::lab {
namespace {

constexpr const char* kNone = "-";
constexpr const char* kOpened = "opened";
constexpr const char* kClosed = "closed in both";
constexpr double kDegrees = 180.0 / std::numbers::pi;

std::string share(std::optional<double> value) { return value ? fmt::format("{:.2f}", *value) : kNone; }
std::string metres(std::optional<double> value) { return value ? fmt::format("{:.3f}", *value) : kNone; }
std::string whole(std::size_t value) { return fmt::format("{}", value); }
std::string millimetres(double metres) { return fmt::format("{:.1f}", 1e3 * metres); }
std::string degrees(const PoseError& error) { return fmt::format("{:.2f}", error.degrees()); }
std::string published_range_text(const ValueRange& span) {
    return fmt::format("{:.2f} to {:.2f}", span.low, span.high);
}

const std::vector<std::string> kComparisonHead{"matched",   "only first", "only second", "persistence",
                                               "stability", "mean m",     "sd m",        "linearity",
                                               "evenness",  "fill",       "continuity"};

std::vector<std::string> comparison_cells(const Comparison& comparison) {
    const auto& [matched, persistence, stability, mean, sigma] = comparison.metrics;
    const auto& continuity = comparison.continuity;
    return {whole(matched),
            whole(comparison.only_first),
            whole(comparison.only_second),
            share(persistence),
            share(stability),
            metres(mean),
            metres(sigma),
            share(continuity.linearity),
            share(continuity.evenness),
            share(continuity.fill),
            share(continuity.mean())};
}

const char* door_text(const NeighbourResult& neighbour) { return neighbour.door_moved ? kOpened : kClosed; }

const char* certainty_text(landmarks::Certainty certainty) {
    switch (certainty) {
    case landmarks::Certainty::kClear: return "clear";
    case landmarks::Certainty::kAmbiguous: return "ambiguous";
    case landmarks::Certainty::kUndetermined: return "undetermined";
    }
    return kNone;
}

std::vector<std::string> seen_cells(std::string name, std::size_t turns, const SeenLandmarks& seen) {
    return {std::move(name), whole(turns), whole(seen.points.size()), metres(seen.survey.eps),
            whole(seen.survey.landmarks.size())};
}

const std::vector<std::string> kMethodsHead{
    "pairs", "agreeing", "rms mm", "landmarks off by mm", "deg", "surfaces' verdict", "surfaces off by mm", "deg"};

std::vector<std::string> method_cells(const AlignmentMethods& methods) {
    const auto& [pairs, found, refusal] = methods.by_landmarks;
    const auto& [alignment, error] = methods.by_surfaces;
    const auto& fit = found; // clang 14 cannot capture a structured binding
    const auto of_fit = [&](auto text) { return fit ? text(*fit) : std::string(kNone); };
    return {whole(pairs),
            fit ? whole(fit->agreeing) : "refused",
            of_fit([](const LandmarkFit& f) { return millimetres(f.rms); }),
            of_fit([](const LandmarkFit& f) { return millimetres(f.error.metres); }),
            of_fit([](const LandmarkFit& f) { return degrees(f.error); }),
            certainty_text(alignment.certainty),
            millimetres(error.metres),
            degrees(error)};
}

} // namespace

std::string place_name(std::size_t index) { return whole(index + 1); }

std::string pair_name(const NeighbourResult& neighbour) {
    return fmt::format("{} to {}", place_name(neighbour.from), place_name(neighbour.to));
}

Table door_table(const LandmarkResults& results) {
    Table table{joined({"place", "door"}, kComparisonHead), {}};
    for (std::size_t n = 0; n < results.places.size(); ++n) {
        const PlaceResult& place = results.places[n];
        table.rows.push_back(joined({place_name(n), kOpened}, comparison_cells(place.door.comparison)));
        table.rows.push_back(joined({place_name(n), kClosed}, comparison_cells(place.control)));
    }
    table.rows.push_back({"published", "", "", "", "", published_range_text(kPublishedPersistence),
                          published_range_text(kPublishedStability), "", "", "", "", "",
                          published_range_text(kPublishedContinuity)});
    return table;
}

Table neighbour_table(const LandmarkResults& results) {
    Table table{joined({"places", "door"}, kComparisonHead), {}};
    for (const NeighbourResult& neighbour : results.neighbours) {
        table.rows.push_back(
            joined({pair_name(neighbour), door_text(neighbour)}, comparison_cells(neighbour.comparison)));
    }
    return table;
}

Table tolerance_table(const LandmarkResults& results) {
    Table table{{"tolerance m", "matched", "persistence", "stability", "mean m", "sd m"}, {}};
    for (const auto& [tolerance, metrics] : results.tolerances) {
        table.rows.push_back({fmt::format("{:.1f}", tolerance), whole(metrics.matched), share(metrics.persistence),
                              share(metrics.stability), metres(metrics.distance_mean), metres(metrics.distance_sigma)});
    }
    table.rows.push_back({fmt::format("published, {:.1f}", kPublishedTolerance), "", "", "",
                          metres(kPublishedDistanceMean), metres(kPublishedDistanceSigma)});
    return table;
}

Table readings_table(const LandmarkResults& results) {
    Table table{{"readings", "points", "eps m", "landmarks", "robot's bytes", "server's bytes"}, {}};
    for (const ReadingsRow& row : results.readings) {
        table.rows.push_back({whole(row.readings), whole(row.points), metres(row.eps), whole(row.landmarks),
                              whole(row.robot_bytes), whole(row.server_bytes)});
    }
    return table;
}

Table readings_times_table(const LandmarkResults& results) {
    Table table{{"readings", "points", "median ms", "ns a point"}, {}};
    for (const ReadingsRow& row : results.readings) {
        table.rows.push_back({whole(row.readings), whole(row.points), fmt::format("{:.2f}", row.milliseconds),
                              fmt::format("{:.0f}", 1e6 * row.milliseconds / static_cast<double>(row.points))});
    }
    return table;
}

Table window_table(const LandmarkResults& results) {
    Table table{{"window", "RMSE m", "noise reduction x", "noise reduction y", "error on walls m", "at corners m"}, {}};
    for (const FilterRow& row : results.windows) {
        table.rows.push_back({whole(row.window), metres(row.figures.rmse), share(row.figures.noise_reduction_x),
                              share(row.figures.noise_reduction_y), metres(row.wall_error), metres(row.corner_error)});
    }
    return table;
}

Table alignment_table(const LandmarkResults& results) {
    Table table{{"places", "door", "verdict", "x m", "y m", "yaw deg", "off by mm", "off by deg", "inlier ratio",
                 "outlier ratio", "3 sigma mm"},
                {}};
    for (const NeighbourResult& neighbour : results.neighbours) {
        const auto& [found, error] = neighbour.methods.by_surfaces;
        table.rows.push_back({pair_name(neighbour), door_text(neighbour), certainty_text(found.certainty),
                              metres(found.T_first_second.x), metres(found.T_first_second.y),
                              fmt::format("{:.2f}", kDegrees * found.T_first_second.yaw), millimetres(error.metres),
                              degrees(error), share(found.explained), share(found.contradicted),
                              millimetres(3.0 * found.position_sigma)});
    }
    return table;
}

Table methods_table(const LandmarkResults& results) {
    Table table{joined({"places", "door"}, kMethodsHead), {}};
    for (std::size_t n = 0; n < results.places.size(); ++n) {
        table.rows.push_back(joined({place_name(n), kOpened}, method_cells(results.places[n].door_methods)));
        table.rows.push_back(joined({place_name(n), kClosed}, method_cells(results.places[n].control_methods)));
    }
    for (const NeighbourResult& neighbour : results.neighbours) {
        table.rows.push_back(joined({pair_name(neighbour), door_text(neighbour)}, method_cells(neighbour.methods)));
    }
    return table;
}

Table recording_table(const RecordedResult& recorded) {
    const std::size_t half = recorded.turns / 2;
    return {{"part", "turns", "points", "eps m", "landmarks"},
            {seen_cells("whole", recorded.turns, recorded.all), seen_cells("first half", half, recorded.halves.first),
             seen_cells("second half", recorded.turns - half, recorded.halves.second)}};
}

Table halves_table(const RecordedResult& recorded) {
    return {kComparisonHead, {comparison_cells(recorded.halves.comparison)}};
}

Table halves_methods_table(const RecordedResult& recorded) { return {kMethodsHead, {method_cells(recorded.methods)}}; }

} // namespace scanloom::lab
