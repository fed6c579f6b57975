#include "server/landmarks/landmark.hpp"

#include "server/landmarks/adaptive_eps.hpp"
#include "server/landmarks/continuity.hpp"
#include "server/landmarks/median.hpp"
#include "server/landmarks/point_check.hpp"

#include <algorithm>
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

} // namespace scanloom::landmarks
