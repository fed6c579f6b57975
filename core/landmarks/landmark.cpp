#include "core/landmarks/landmark.hpp"

#include "core/landmarks/acceptance_test.hpp"
#include "core/landmarks/clustering.hpp"
#include "core/landmarks/point_index.hpp"
#include "core/landmarks/points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace scanloom::landmarks {
namespace {

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

namespace {

/// The distinct points of a set, in the order of their first occurrence.
struct Distinct {
    explicit Distinct(std::span<const Point2> all) {
        auto [its_points, counts, of] = distinct_points(all);
        points = std::move(its_points);
        for (std::size_t n = 0; n < all.size(); ++n) {
            if (of[n] == first_of.size()) first_of.push_back(n);
        }
        tree = PointTree(points);
    }

    std::vector<Point2> points;
    std::vector<std::size_t> first_of; // for each distinct point, its lowest index in the set
    PointTree tree{{}};
};

} // namespace

Result<std::vector<Match>> match(std::span<const Point2> first, std::span<const Point2> second, double tolerance) {
    if (auto good = check_points(first, "first"); !good) return good.error();
    if (auto good = check_points(second, "second"); !good) return good.error();
    if (!(tolerance >= 0.0) || !std::isfinite(tolerance)) {
        return Error{Errc::kInvalidField,
                     fmt::format("tolerance is {:g} m; it must be finite and 0 or more", tolerance)};
    }
    std::vector<Match> matches;
    if (first.empty() || second.empty()) return matches;
    // Of equal points only the first can be matched. In trees of all points, each equal point would examine all the
    // others.
    const Distinct here(first);
    const Distinct there(second);
    for (std::size_t n = 0; n < here.points.size(); ++n) {
        const auto [other, distance] = *there.tree.nearest(here.points[n]);
        if (distance > tolerance) continue;
        if (here.tree.nearest(there.points[other])->index != n) continue;
        matches.push_back({here.first_of[n], there.first_of[other], distance});
    }
    return matches;
}

Metrics metrics_of(std::span<const Match> matches, std::size_t first_count, double tolerance) {
    assert(matches.size() <= first_count);
    Metrics metrics{.matched = matches.size()};
    const auto count = static_cast<double>(matches.size());
    if (first_count > 0) metrics.persistence = count / static_cast<double>(first_count);
    if (matches.empty()) return metrics;
    const auto close = std::ranges::count_if(
        matches, [&](double d) { return d <= tolerance / 2.0; }, &Match::distance);
    metrics.stability = static_cast<double>(close) / count;
    double sum = 0.0;
    for (const Match& match : matches) sum += match.distance;
    const double mean = sum / count;
    double squares = 0.0;
    for (const Match& match : matches) squares += (match.distance - mean) * (match.distance - mean);
    metrics.distance_mean = mean;
    metrics.distance_sigma = std::sqrt(squares / count);
    return metrics;
}

} // namespace scanloom::landmarks
