#include "lab/landmark_comparison.hpp"

#include "core/landmarks/filter_figures.hpp"
#include "core/landmarks/landmark.hpp"
#include "core/landmarks/landmark_matching.hpp"
#include "core/landmarks/points.hpp"
#include "lab/recording.hpp"
#include "robot_client/sources/stationary_detector.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace scanloom::lab {
namespace {

std::vector<landmarks::Continuity> continuity_of_each(std::span<const Point2> points,
                                                      const landmarks::LandmarkSurvey& survey) {
    std::vector<std::vector<Point2>> members(survey.landmarks.size());
    for (std::size_t n = 0; n < points.size(); ++n) {
        const auto cluster = survey.clustering.cluster_of[n];
        if (cluster != landmarks::kNoise) members[static_cast<std::size_t>(cluster)].push_back(points[n]);
    }
    std::vector<landmarks::Continuity> continuity;
    continuity.reserve(members.size());
    for (const auto& cluster : members) continuity.push_back(landmarks::continuity_of(cluster, survey.eps));
    return continuity;
}

landmarks::Continuity mean_continuity(const SeenLandmarks& first, const SeenLandmarks& second) {
    const std::size_t count = first.continuity.size() + second.continuity.size();
    landmarks::Continuity mean;
    for (const auto* seen : {&first, &second}) {
        for (const auto& [linearity, evenness, fill] : seen->continuity) {
            mean.linearity += linearity / static_cast<double>(count);
            mean.evenness += evenness / static_cast<double>(count);
            mean.fill += fill / static_cast<double>(count);
        }
    }
    return mean;
}

} // namespace

Result<SeenLandmarks> see_landmarks(std::vector<Point2> points) {
    auto survey = landmarks::survey_landmarks(points);
    if (!survey) return survey.error();
    auto continuity = continuity_of_each(points, *survey);
    return SeenLandmarks{std::move(points), std::move(*survey), std::move(continuity)};
}

Result<Comparison> compare(const SeenLandmarks& first, const SeenLandmarks& second, double tolerance) {
    const auto& of_first = first.survey.landmarks;
    const auto& of_second = second.survey.landmarks;
    auto matches = landmarks::match(positions_of(of_first), positions_of(of_second), tolerance);
    if (!matches) return matches.error();
    Comparison comparison;
    comparison.metrics = landmarks::metrics_of(*matches, of_first.size(), tolerance);
    comparison.only_first = of_first.size() - matches->size();
    comparison.only_second = of_second.size() - matches->size();
    comparison.continuity = mean_continuity(first, second);
    comparison.matches = std::move(*matches);
    return comparison;
}

namespace {

constexpr double kCornerBend = 0.05; // metres
constexpr std::size_t kCornerReach = 3;

Result<double> median_milliseconds(std::span<const Point2> points, const Now& now) {
    std::vector<double> times;
    for (int n = 0; n < kTimings; ++n) {
        const double begun = now();
        const auto found = landmarks::find_landmarks(points);
        if (!found) return found.error();
        times.push_back(1e3 * (now() - begun));
    }
    return landmarks::median(times);
}

Result<ReadingsRow> readings_row(std::span<const Scan> scans, const Sensor& sensor, const Now& now) {
    auto seen = see_landmarks(points_in_map(scans, sensor));
    if (!seen) return seen.error();
    const auto milliseconds = median_milliseconds(seen->points, now);
    if (!milliseconds) return milliseconds.error();
    const double eps = seen->survey.eps;
    return ReadingsRow{.readings = scans.size(),
                       .points = seen->points.size(),
                       .landmarks = seen->survey.landmarks.size(),
                       .eps = eps,
                       .robot_bytes = robot_bytes(scans),
                       .server_bytes = clustering_bytes(seen->points, eps),
                       .milliseconds = *milliseconds};
}

/// Returns which beams of a full circle are at a corner or an edge.
std::vector<bool> beams_at_corners(const Scan& scan, const Sensor& sensor) {
    const auto points = points_of(std::span(&scan, 1), sensor);
    const std::size_t count = points.size();
    assert(count == scan.ranges.size() && count > 2);
    std::vector<bool> at_corner(count, false);
    for (std::size_t n = 0; n < count; ++n) {
        const Point2 bend = points[(n + count - 1) % count] - 2.0 * points[n] + points[(n + 1) % count];
        if (norm(bend) <= kCornerBend) continue;
        for (std::size_t near = count + n - kCornerReach; near <= count + n + kCornerReach; ++near) {
            at_corner[near % count] = true;
        }
    }
    return at_corner;
}

/// Collects the effect of one window on successive scans.
class WindowFigures {
public:
    void add(const landmarks::FilterFigures& figures) {
        squares_ += figures.rmse * figures.rmse;
        reductions_x_.push_back(figures.noise_reduction_x.value_or(0.0));
        reductions_y_.push_back(figures.noise_reduction_y.value_or(0.0));
    }
    void add_error(bool at_corner, double metres) { (at_corner ? corner_errors_ : wall_errors_).push_back(metres); }

    [[nodiscard]] FilterRow row(std::size_t window) {
        const auto mean = [](const std::vector<double>& values) {
            double sum = 0.0;
            for (const double value : values) sum += value;
            return sum / static_cast<double>(values.size());
        };
        const auto middle = [](std::vector<double>& values) {
            return values.empty() ? 0.0 : landmarks::median(values);
        };
        const double rmse = std::sqrt(squares_ / static_cast<double>(reductions_x_.size()));
        return {window, {rmse, mean(reductions_x_), mean(reductions_y_)}, middle(wall_errors_), middle(corner_errors_)};
    }

private:
    double squares_ = 0.0;
    std::vector<double> reductions_x_;
    std::vector<double> reductions_y_;
    std::vector<double> wall_errors_;
    std::vector<double> corner_errors_;
};

} // namespace

Result<std::vector<ToleranceRow>>
sweep_tolerances(std::span<const std::pair<const SeenLandmarks*, const SeenLandmarks*>> pairs) {
    std::vector<ToleranceRow> rows;
    for (const double tolerance : kTolerances) {
        std::vector<landmarks::Match> matches;
        std::size_t first_count = 0;
        for (const auto& [first, second] : pairs) {
            const auto comparison = compare(*first, *second, tolerance);
            if (!comparison) return comparison.error();
            matches.insert(matches.end(), comparison->matches.begin(), comparison->matches.end());
            first_count += first->survey.landmarks.size();
        }
        rows.push_back({tolerance, landmarks::metrics_of(matches, first_count, tolerance)});
    }
    return rows;
}

Result<std::vector<ReadingsRow>> sweep_readings(const LidarCapture& capture, const Now& now) {
    std::vector<ReadingsRow> rows;
    for (const std::size_t readings : kReadings) {
        if (readings > capture.scans.size()) break;
        const auto row = readings_row(std::span(capture.scans).first(readings), capture.sensor, now);
        if (!row) return row.error();
        rows.push_back(*row);
    }
    return rows;
}

std::vector<FilterRow> sweep_windows(const LidarCapture& capture, const Scan& without_noise) {
    const auto at_corner = beams_at_corners(without_noise, capture.sensor);
    std::vector<std::int32_t> steps(without_noise.ranges.size()); // evenly over the full circle
    std::iota(steps.begin(), steps.end(), 0);
    std::vector<FilterRow> rows;
    for (const std::size_t window : kWindows) {
        WindowFigures figures;
        for (const Scan& scan : capture.scans) {
            const auto filtered = robot::median_filtered(scan.ranges, steps, static_cast<std::int32_t>(steps.size()),
                                                         static_cast<int>(window));
            figures.add(landmarks::filter_figures(scan.ranges, filtered, angles_of(scan, capture.sensor)));
            for (std::size_t n = 0; n < filtered.size(); ++n) {
                figures.add_error(at_corner[n], 1e-3 * std::abs(static_cast<double>(filtered[n]) -
                                                                static_cast<double>(without_noise.ranges[n])));
            }
        }
        rows.push_back(figures.row(window));
    }
    return rows;
}

} // namespace scanloom::lab
