#include "lab/landmark_findings.hpp"

#include "lab/landmark_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace scanloom::lab {
namespace {

constexpr const char* kDoorOpened = ", door opened";

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
    auto text = fmt::format("{} is {}, {} the published {:.2f} to {:.2f}", what, range_text(values), place,
                            published.low, published.high);
    return place == "within" ? text + "." : fmt::format("{}: {}", text, why);
}

/// "1 to 2, door opened"
std::string named(const NeighbourResult& neighbour) {
    return pair_name(neighbour) + (neighbour.door_moved ? kDoorOpened : "");
}

/// Errors of poses, and the number of poses requested.
class Errors {
public:
    void add(const PoseError* error) {
        ++requested_;
        if (!error) return;
        millimetres_.push_back(error->millimetres());
        degrees_.push_back(error->degrees());
    }

    /// "5 of 6 transforms, off by 0.4 to 2.1 mm and 0.01 to 0.30 degrees"
    [[nodiscard]] std::string text() const {
        if (millimetres_.empty()) return fmt::format("none of {} transforms", requested_);
        return fmt::format("{} of {} transforms, off by {} mm and {} degrees", millimetres_.size(), requested_,
                           range_text(millimetres_, 1), range_text(degrees_));
    }

private:
    std::size_t requested_ = 0;
    std::vector<double> millimetres_;
    std::vector<double> degrees_;
};

/// Errors of both methods for some pairs of captures.
struct MethodErrors {
    Errors by_landmarks;
    Errors by_surfaces; ///< only clear alignments

    void add(const AlignmentMethods& methods) {
        const auto& [alignment, error] = methods.by_surfaces;
        by_landmarks.add(methods.by_landmarks.fit ? &methods.by_landmarks.fit->error : nullptr);
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
                            3.0 * kPublishedContinuity.high - 1.0)),
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

std::vector<std::string> alignment_findings(const LandmarkResults& results) {
    std::vector<std::string> findings;
    std::size_t clear = 0;
    double position = 0.0;
    double yaw = 0.0;
    for (const NeighbourResult& neighbour : results.neighbours) {
        const auto& [alignment, error] = neighbour.methods.by_surfaces;
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
                               : fmt::format("{} of {} are clear, with errors of at most {:.1f} mm and {:.2f} degrees.",
                                             clear, results.neighbours.size(), position, yaw));
    return findings;
}

std::vector<std::string> method_findings(const LandmarkResults& results) {
    MethodErrors same;
    MethodErrors next;
    std::vector<std::string> refusals;
    const auto note = [&](MethodErrors& errors, const AlignmentMethods& methods, const std::string& name) {
        errors.add(methods);
        const std::string& refusal = methods.by_landmarks.refusal;
        if (!refusal.empty()) refusals.push_back(fmt::format("{}: refused by landmarks: {}.", name, refusal));
    };
    for (std::size_t n = 0; n < results.places.size(); ++n) {
        note(same, results.places[n].door_methods, place_name(n) + kDoorOpened);
        note(same, results.places[n].control_methods, place_name(n));
    }
    for (const NeighbourResult& neighbour : results.neighbours) note(next, neighbour.methods, named(neighbour));
    std::vector<std::string> findings{
        fmt::format("For one place, landmarks give {}; surfaces {}. The medians of the same clusters hardly move "
                    "there. But matching requires both sets in one frame with an error below the tolerance, {} m, and "
                    "used the true poses here: landmarks can refine an approximate pose, but cannot find one.",
                    same.by_landmarks.text(), same.by_surfaces.text(), landmarks::kTolerance),
        fmt::format("From one place to the next, landmarks give {}; surfaces {}. Other parts of a wall are visible "
                    "from there, and the median of a cluster is the middle of the visible part, not of the wall: few "
                    "landmarks match even with the true poses, and matching ones may be different parts of an object.",
                    next.by_landmarks.text(), next.by_surfaces.text()),
        "Therefore align() uses surface elements: a wall is on the same line from every viewpoint, and every part of "
        "it that is visible in both captures counts."};
    findings.insert(findings.end(), refusals.begin(), refusals.end());
    return findings;
}

std::string recording_finding(const RecordedResult& recorded) {
    const Comparison& comparison = recorded.halves.comparison;
    const auto compared = [](std::string_view what, const std::optional<double>& value, const ValueRange& published) {
        if (!value) return fmt::format("{} cannot be computed", what);
        return fmt::format("{} is {:.2f}, {} the published {:.2f} to {:.2f}", what, *value,
                           placed(std::span(&*value, 1), published), published.low, published.high);
    };
    return fmt::format("{}; {}; {}. Between the halves nothing was moved on purpose, and the lidar was stationary.",
                       compared("Persistence", persistence(comparison), kPublishedPersistence),
                       compared("stability", stability(comparison), kPublishedStability),
                       compared("continuity", continuity(comparison), kPublishedContinuity));
}

} // namespace scanloom::lab
