#include "lab/landmark_findings.hpp"

#include "lab/landmark_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace scanloom::lab {
namespace {

constexpr const char* kDoorOpened = ", door opened";

std::string range_text(std::span<const double> values, int digits = 2) {
    if (values.empty()) return "nothing";
    const auto [low, high] = std::ranges::minmax(values);
    const auto low_text = fmt::format("{:.{}f}", low, digits);
    const auto high_text = fmt::format("{:.{}f}", high, digits);
    return low_text == high_text ? low_text : fmt::format("{} to {}", low_text, high_text);
}

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
    if (values.empty()) return fmt::format("{} is told of nothing: no landmarks matched.", what);
    const std::string place = placed(values, published);
    auto text = fmt::format("{} is {}, {} the published {:.2f} to {:.2f}", what, range_text(values), place,
                            published.low, published.high);
    return place == "within" ? text + "." : fmt::format("{}: {}", text, why);
}

/// "1 to 2, door opened"
std::string named(const NeighbourResult& neighbour) {
    return way_name(neighbour) + (neighbour.door_moved ? kDoorOpened : "");
}

/// Errors of poses, and the number of poses requested.
class Errors {
public:
    void add(const PoseError* error) {
        ++asked_;
        if (!error) return;
        millimetres_.push_back(error->millimetres());
        degrees_.push_back(error->degrees());
    }

    /// "5 of 6 transforms, off by 0.4 to 2.1 mm and 0.01 to 0.30 degrees"
    [[nodiscard]] std::string text() const {
        if (millimetres_.empty()) return fmt::format("none of {} transforms", asked_);
        return fmt::format("{} of {} transforms, off by {} mm and {} degrees", millimetres_.size(), asked_,
                           range_text(millimetres_, 1), range_text(degrees_));
    }

private:
    std::size_t asked_ = 0;
    std::vector<double> millimetres_;
    std::vector<double> degrees_;
};

/// Errors of both methods for some pairs of captures.
struct WaysErrors {
    Errors by_landmarks;
    Errors by_surfaces; ///< only clear alignments

    void add(const WaysToAlign& ways) {
        const auto& [alignment, error] = ways.by_surfaces;
        by_landmarks.add(ways.by_landmarks.fit ? &ways.by_landmarks.fit->error : nullptr);
        by_surfaces.add(alignment.certainty == landmarks::Certainty::kClear ? &error : nullptr);
    }
};

} // namespace

std::string placed(std::span<const double> values, const ValueRange& published) {
    const auto [low, high] = std::ranges::minmax(values);
    const auto hundredths = [](double value) { return std::lround(100.0 * value); };
    if (hundredths(low) > hundredths(published.high)) return "above";
    if (hundredths(high) < hundredths(published.low)) return "below";
    if (hundredths(low) >= hundredths(published.low) && hundredths(high) <= hundredths(published.high)) return "within";
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
                fmt::format("the lidar stands in the very same place, and nothing but the door moves. With nothing "
                            "moved it is {}, which is what noise alone leaves; where the lidar has moved to the next "
                            "place it is {}, as other parts of things are seen from there and their medians lie "
                            "elsewhere.",
                            range_text(values_of(still, persistence)), range_text(values_of(elsewhere, persistence)))),
        against("Stability", values_of(moved, stability), kPublishedStability,
                fmt::format("medians over {} turns hardly move, by {} m on the mean where nothing is moved, while half "
                            "the tolerance is {} m; between neighbouring places it is {}.",
                            kTurns, range_text(values_of(still, distance), 3), landmarks::kTolerance / 2.0,
                            range_text(values_of(elsewhere, stability)))),
        against(
            "Continuity", values_of(moved, continuity), kPublishedContinuity,
            fmt::format("fill is {}, as no step within a cluster is longer than eps and none counts as a break up "
                        "to 2 eps; linearity is {}, walls and furniture being straight; evenness is {}. With such a "
                        "fill the published figure leaves {:.2f} at most for linearity and evenness together: its "
                        "clusters were less like lines, or fill was reckoned otherwise.",
                        part(&Continuity::fill), part(&Continuity::linearity), part(&Continuity::evenness),
                        3.0 * kPublishedContinuity.high - 1.0)),
    };
}

std::string tolerance_finding(const LandmarkResults& results) {
    const auto row = std::ranges::find(results.tolerances, kPublishedTolerance, &ToleranceRow::tolerance);
    if (row == results.tolerances.end() || !row->metrics.distance_mean) {
        return fmt::format("At {} m nothing is matched.", kPublishedTolerance);
    }
    const auto compared = [](double ours, double published) {
        const auto millimetres = [](double value) { return std::lround(1e3 * value); };
        if (millimetres(ours) == millimetres(published)) return "equal to";
        return ours > published ? "above" : "below";
    };
    return fmt::format(
        "At {} m the mean distance is {:.3f} m, {} the published {} m, and its standard deviation {:.3f} m, {} the "
        "published {} m. The poses are exact here and the same for both captures: what is left is the noise of medians "
        "over {} turns, and clusters that came out otherwise.",
        kPublishedTolerance, *row->metrics.distance_mean, compared(*row->metrics.distance_mean, kPublishedDistanceMean),
        kPublishedDistanceMean, *row->metrics.distance_sigma,
        compared(*row->metrics.distance_sigma, kPublishedDistanceSigma), kPublishedDistanceSigma, kTurns);
}

std::string window_finding(const std::vector<FilterRow>& rows) {
    const FilterRow& unfiltered = rows.front();
    const auto rounds = [&](const FilterRow& row) { return row.corner_error > unfiltered.corner_error; };
    const auto best = std::ranges::min_element(rows, {}, &FilterRow::wall_error);
    const auto begin = std::ranges::find_if(rows, rounds);
    const auto walls = fmt::format("On walls a window of {} is best: {:.3f} m instead of {:.3f} m. ", best->window,
                                   best->wall_error, unfiltered.wall_error);
    if (begin == rows.end()) return walls + "At corners no window does harm.";
    const auto twice = std::ranges::find_if(
        rows, [&](const FilterRow& row) { return row.corner_error >= 2.0 * unfiltered.corner_error; });
    auto text =
        walls + fmt::format("Corners go round from a window of {} on, where they are {:.3f} m from the truth, further "
                            "than the {:.3f} m of unfiltered ones",
                            begin->window, begin->corner_error, unfiltered.corner_error);
    if (twice != rows.end()) {
        text += fmt::format("; from {} on they are more than twice as far off", twice->window);
    }
    const FilterRow& widest = rows.back();
    return text + fmt::format("; with {} they are {:.2f} m off.", widest.window, widest.corner_error);
}

std::vector<std::string> alignment_findings(const LandmarkResults& results) {
    std::vector<std::string> findings;
    std::size_t clear = 0;
    double position = 0.0;
    double yaw = 0.0;
    for (const NeighbourResult& neighbour : results.neighbours) {
        const auto& [alignment, error] = neighbour.ways.by_surfaces;
        if (alignment.certainty != landmarks::Certainty::kClear) {
            findings.push_back(named(neighbour) + ": " + alignment.why);
            continue;
        }
        ++clear;
        position = std::max(position, error.millimetres());
        yaw = std::max(yaw, error.degrees());
    }
    findings.insert(findings.begin(),
                    clear == 0 ? std::string("None is clear.")
                               : fmt::format("{} of {} are clear, and these are off by {:.1f} mm and {:.2f} degrees at "
                                             "most.",
                                             clear, results.neighbours.size(), position, yaw));
    return findings;
}

std::vector<std::string> ways_findings(const LandmarkResults& results) {
    WaysErrors same;
    WaysErrors next;
    std::vector<std::string> refusals;
    const auto note = [&](WaysErrors& errors, const WaysToAlign& ways, const std::string& name) {
        errors.add(ways);
        const std::string& refusal = ways.by_landmarks.refusal;
        if (!refusal.empty()) refusals.push_back(fmt::format("{}: refused by landmarks: {}.", name, refusal));
    };
    for (std::size_t n = 0; n < results.places.size(); ++n) {
        note(same, results.places[n].door_ways, place_name(n) + kDoorOpened);
        note(same, results.places[n].control_ways, place_name(n));
    }
    for (const NeighbourResult& neighbour : results.neighbours) note(next, neighbour.ways, named(neighbour));
    std::vector<std::string> findings{
        fmt::format("Of one place landmarks tell {}; surfaces {}. The medians of the same clusters hardly move there. "
                    "But matching needs both sets in one frame to within the tolerance, {} m, and had the true poses: "
                    "landmarks refine a pose that is nearly known and do not find one.",
                    same.by_landmarks.text(), same.by_surfaces.text(), landmarks::kTolerance),
        fmt::format("Of one place and the next landmarks tell {}; surfaces {}. Other parts of a wall are seen from "
                    "there, and the median of a cluster is the middle of what was seen, not of the wall: few landmarks "
                    "match even by the true poses, and those that do need not be the same part of a thing.",
                    next.by_landmarks.text(), next.by_surfaces.text()),
        "So align() uses surface elements: a wall lies on the same line from wherever it is seen, and every piece of "
        "it that both saw counts."};
    findings.insert(findings.end(), refusals.begin(), refusals.end());
    return findings;
}

std::string recording_finding(const RecordedResult& recorded) {
    const Comparison& comparison = recorded.halves.comparison;
    const auto beside = [](std::string_view what, const std::optional<double>& value, const ValueRange& published) {
        if (!value) return fmt::format("{} is told of nothing", what);
        return fmt::format("{} is {:.2f}, {} the published {:.2f} to {:.2f}", what, *value,
                           placed(std::span(&*value, 1), published), published.low, published.high);
    };
    return fmt::format("{}; {}; {}. Nothing was moved between the halves on purpose, and the lidar stood still.",
                       beside("Persistence", persistence(comparison), kPublishedPersistence),
                       beside("stability", stability(comparison), kPublishedStability),
                       beside("continuity", continuity(comparison), kPublishedContinuity));
}

} // namespace scanloom::lab
