#include "lab/landmark_findings.hpp"

#include "lab/markdown.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace scanloom::lab {
namespace {

/// Returns the values of those comparisons that have one.
template <class Choose>
std::vector<double> values_of(std::span<const Comparison* const> comparisons, Choose&& choose) {
    std::vector<double> values;
    for (const Comparison* comparison : comparisons) {
        if (const std::optional<double> value = choose(*comparison)) values.push_back(*value);
    }
    return values;
}

std::optional<double> persistence(const Comparison& c) { return c.metrics.persistence; }
std::optional<double> stability(const Comparison& c) { return c.metrics.stability; }
std::optional<double> distance(const Comparison& c) { return c.metrics.distance_mean; }
std::optional<double> continuity(const Comparison& c) { return c.continuity.mean(); }

/// "Persistence is 0.73 to 0.92, above the published 0.18 to 0.49: " and the reason; no reason if all values are
/// within.
std::string against(std::string_view what, std::span<const double> values, const ValueRange& published,
                    const std::string& why) {
    if (values.empty()) return fmt::format("{} cannot be computed: no landmarks matched.", what);
    const std::string place = placed(values, published);
    const auto text =
        fmt::format("{} is {}, {} the published {}", what, range_text(values), place, range_text(published));
    return place == "within" ? text + "." : fmt::format("{}: {}", text, why);
}

} // namespace

std::string placed(std::span<const double> values, const ValueRange& published) {
    const auto [low, high] = std::ranges::minmax(values);
    const auto hundredths = [](double value) { return std::lround(100.0 * value); };
    if (hundredths(low) > hundredths(published[1])) return "above";
    if (hundredths(high) < hundredths(published[0])) return "below";
    if (hundredths(low) >= hundredths(published[0]) && hundredths(high) <= hundredths(published[1])) return "within";
    return "partly outside";
}

std::vector<std::string> door_findings(const LandmarkResults& results) {
    std::vector<const Comparison*> moved;
    std::vector<const Comparison*> still;
    std::vector<const Comparison*> elsewhere;
    for (const PlaceResult& place : results.places) {
        moved.push_back(&place.door.comparison);
        still.push_back(&place.control);
    }
    for (const NeighbourResult& neighbour : results.neighbours) elsewhere.push_back(&neighbour.comparison);
    const auto part = [&](auto member) {
        return range_text(values_of(moved, [&](const Comparison& c) { return std::optional(c.continuity.*member); }));
    };
    using landmarks::Continuity;
    return {
        against("Persistence", values_of(moved, persistence), kPublishedPersistence,
                fmt::format("the lidar stands in the same place, and only the door moves. Without a moved door it is "
                            "{}, the effect of noise alone; from one place to the next place it is {}, because other "
                            "parts of objects are visible from there and their medians differ.",
                            range_text(values_of(still, persistence)), range_text(values_of(elsewhere, persistence)))),
        against("Stability", values_of(moved, stability), kPublishedStability,
                fmt::format("medians over {} turns hardly move, by {} m on average without a moved door, while half "
                            "the tolerance is {} m; between neighbouring places it is {}.",
                            kTurns, range_text(values_of(still, distance), 3), landmarks::kTolerance / 2.0,
                            range_text(values_of(elsewhere, stability)))),
        against("Continuity", values_of(moved, continuity), kPublishedContinuity,
                fmt::format("fill is {}, because no step within a cluster is longer than eps, and steps up to 2 eps "
                            "are no gaps; linearity is {}, because walls and furniture are straight; evenness is {}. "
                            "With this fill, the published value allows at most {:.2f} for the sum of linearity and "
                            "evenness: its clusters were less linear, or fill was defined differently.",
                            part(&Continuity::fill), part(&Continuity::linearity), part(&Continuity::evenness),
                            3.0 * kPublishedContinuity[1] - 1.0)),
    };
}

std::string tolerance_finding(const LandmarkResults& results) {
    const auto row = std::ranges::find(results.tolerances, kPublishedTolerance, &ToleranceRow::tolerance);
    if (row == results.tolerances.end() || !row->metrics.distance_mean) {
        return fmt::format("At {} m no landmarks match.", kPublishedTolerance);
    }
    const auto compared = [](double ours, double published) {
        const auto millimetres = [](double value) { return std::lround(1e3 * value); };
        if (millimetres(ours) == millimetres(published)) return "equal to";
        return ours > published ? "above" : "below";
    };
    return fmt::format("At {} m the mean distance is {:.3f} m, {} the published {} m, and its standard deviation "
                       "{:.3f} m, {} the published {} m. Here the poses are exact and equal for both captures: the "
                       "remaining differences are the noise of medians over {} turns, and different clusters.",
                       kPublishedTolerance, *row->metrics.distance_mean,
                       compared(*row->metrics.distance_mean, kPublishedDistanceMean), kPublishedDistanceMean,
                       *row->metrics.distance_sigma, compared(*row->metrics.distance_sigma, kPublishedDistanceSigma),
                       kPublishedDistanceSigma, kTurns);
}

std::string window_finding(const std::vector<FilterRow>& rows) {
    const FilterRow& unfiltered = rows.front();
    const auto rounds = [&](const FilterRow& row) { return row.corner_error > unfiltered.corner_error; };
    const auto best = std::ranges::min_element(rows, {}, &FilterRow::wall_error);
    const auto begin = std::ranges::find_if(rows, rounds);
    const auto walls = fmt::format("On walls a window of {} is best: {:.3f} m instead of {:.3f} m. ", best->window,
                                   best->wall_error, unfiltered.wall_error);
    if (begin == rows.end()) return walls + "No window increases the error at corners.";
    const auto twice = std::ranges::find_if(
        rows, [&](const FilterRow& row) { return row.corner_error >= 2.0 * unfiltered.corner_error; });
    auto text = walls + fmt::format("Corners are rounded from a window of {}, where their error is {:.3f} m, larger "
                                    "than the {:.3f} m of unfiltered corners",
                                    begin->window, begin->corner_error, unfiltered.corner_error);
    if (twice != rows.end()) {
        text += fmt::format("; from {} it is more than twice as large", twice->window);
    }
    const FilterRow& widest = rows.back();
    return text + fmt::format("; with {} it is {:.2f} m.", widest.window, widest.corner_error);
}

std::string recording_finding(const RecordedResult& recorded) {
    const Comparison& comparison = recorded.halves.comparison;
    const auto compared = [](std::string_view what, const std::optional<double>& value, const ValueRange& published) {
        if (!value) return fmt::format("{} cannot be computed", what);
        return fmt::format("{} is {:.2f}, {} the published {}", what, *value, placed(std::span(&*value, 1), published),
                           range_text(published));
    };
    return fmt::format("{}; {}; {}", compared("Persistence", persistence(comparison), kPublishedPersistence),
                       compared("stability", stability(comparison), kPublishedStability),
                       compared("continuity", continuity(comparison), kPublishedContinuity));
}

} // namespace scanloom::lab
