#include "core/landmarks/landmark.hpp"

#include "core/landmarks/clustering.hpp"
#include "core/landmarks/points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace scanloom::landmarks {
namespace {

struct Axes {
    double major = 0.0; ///< eigenvalues, square metres
    double minor = 0.0;
    Point2 direction{1.0, 0.0}; ///< of the major axis
};

/// Computes the axes of points. Coordinates are relative to the first point, so that equal points have exactly no
/// extent.
Axes axes_of(std::span<const Point2> points) {
    const auto count = static_cast<double>(points.size());
    Point2 mean{0.0, 0.0};
    for (const Point2& point : points) mean += (point - points.front()) / count;
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;
    for (const Point2& point : points) {
        const Point2 off = point - points.front() - mean;
        xx += off.x * off.x / count;
        xy += off.x * off.y / count;
        yy += off.y * off.y / count;
    }
    const double middle = 0.5 * (xx + yy);
    const double apart = std::hypot(0.5 * (xx - yy), xy);
    Axes axes{middle + apart, std::max(middle - apart, 0.0)};
    // Of the two forms of the eigenvector, the one without cancellation.
    const Point2 direction = xx >= yy ? Point2{axes.major - yy, xy} : Point2{xy, axes.major - xx};
    if (norm(direction) > 0.0) axes.direction = normalized(direction);
    return axes;
}

std::vector<double> gaps_along(std::span<const Point2> points, const Point2& direction) {
    std::vector<double> places(points.size());
    std::ranges::transform(points, places.begin(),
                           [&](const Point2& point) { return dot(point - points.front(), direction); });
    std::ranges::sort(places);
    std::vector<double> gaps(places.size() - 1);
    for (std::size_t n = 0; n < gaps.size(); ++n) gaps[n] = places[n + 1] - places[n];
    return gaps;
}

/// Returns the evenness of gaps; see Continuity.
/// Precondition: mean > 0.
double evenness_of(std::span<const double> gaps, double mean) {
    double variance = 0.0;
    for (const double gap : gaps) variance += (gap - mean) * (gap - mean) / static_cast<double>(gaps.size());
    return 1.0 / (1.0 + std::sqrt(variance) / mean);
}

/// The points of each cluster, in the order of the cloud.
class Members {
public:
    Members(std::span<const Point2> points, const Clustering& clustering) : begin_(clustering.clusters + 1) {
        for (const std::int32_t cluster : clustering.cluster_of) {
            if (cluster != kNoise) ++begin_[static_cast<std::size_t>(cluster) + 1];
        }
        for (std::size_t n = 1; n < begin_.size(); ++n) begin_[n] += begin_[n - 1];
        points_.resize(begin_.back());
        std::vector<std::size_t> next = begin_;
        for (std::size_t n = 0; n < points.size(); ++n) {
            const std::int32_t cluster = clustering.cluster_of[n];
            if (cluster != kNoise) points_[next[static_cast<std::size_t>(cluster)]++] = points[n];
        }
    }

    [[nodiscard]] std::span<const Point2> of(std::size_t cluster) const {
        return std::span(points_).subspan(begin_[cluster], begin_[cluster + 1] - begin_[cluster]);
    }

private:
    std::vector<std::size_t> begin_; // for each cluster, and the end
    std::vector<Point2> points_;
};

/// Returns the landmark of a cluster.
/// Precondition: there is at least one point.
Landmark landmark_of(std::span<const Point2> points, double eps) {
    std::vector<double> values(points.size());
    const auto median_of = [&](auto value) {
        std::ranges::transform(points, values.begin(), value);
        return median(values);
    };
    Landmark landmark;
    landmark.position = {median_of([](const Point2& point) { return point.x; }),
                         median_of([](const Point2& point) { return point.y; })};
    landmark.points = points.size();
    Point2 low = points.front();
    Point2 high = points.front();
    for (const Point2& point : points) {
        low = min_corner(low, point);
        high = max_corner(high, point);
    }
    landmark.size = high - low;
    landmark.spread = median_of([&](const Point2& point) { return norm(point - landmark.position); });
    landmark.continuity = continuity_of(points, eps).mean();
    return landmark;
}

} // namespace

Continuity continuity_of(std::span<const Point2> points, double eps) {
    if (points.size() < 2) return {};
    const Axes axes = axes_of(points);
    if (!(axes.major > 0.0)) return {};
    const std::vector<double> gaps = gaps_along(points, axes.direction);
    double extent = 0.0;
    double filled = 0.0;
    for (const double gap : gaps) {
        extent += gap;
        if (gap < 2.0 * eps) filled += gap;
    }
    if (!(extent > 0.0)) return {};
    return {1.0 - axes.minor / axes.major, evenness_of(gaps, extent / static_cast<double>(gaps.size())),
            filled / extent};
}

std::vector<Point2> positions_of(std::span<const Landmark> landmarks) {
    std::vector<Point2> positions;
    positions.reserve(landmarks.size());
    for (const auto& landmark : landmarks) positions.push_back(landmark.position);
    return positions;
}

Result<LandmarkSurvey> survey_landmarks(std::span<const Point2> points, const LandmarkSettings& settings) {
    if (auto valid = check_points(points); !valid) return valid.error();
    const DistinctPoints distinct = distinct_points(points);
    const auto eps = settings.eps ? Result<double>(*settings.eps) : adaptive_eps(distinct, settings.min_points);
    if (!eps) return eps.error();
    auto clustering = dbscan(distinct, *eps, settings.min_points);
    if (!clustering) return clustering.error();
    LandmarkSurvey survey{{}, std::move(*clustering), *eps};
    const Members members(points, survey.clustering);
    for (std::size_t cluster = 0; cluster < survey.clustering.clusters; ++cluster) {
        survey.landmarks.push_back(landmark_of(members.of(cluster), *eps));
    }
    return survey;
}

Result<std::vector<Landmark>> find_landmarks(std::span<const Point2> points, const LandmarkSettings& settings) {
    auto survey = survey_landmarks(points, settings);
    if (!survey) return survey.error();
    return std::move(survey->landmarks);
}

} // namespace scanloom::landmarks
