#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"
#include "core/landmarks/clustering.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace scanloom::landmarks {

/// How similar a cluster is to a piece of a wall that was seen without interruption. Each value is in [0, 1].
struct Continuity {
    double linearity = 0.0; ///< 1 - minor / major eigenvalue of the points' covariance
    double evenness = 0.0;  ///< 1 / (1 + cv), cv the standard deviation of the gaps divided by their mean
    double fill = 0.0;      ///< fraction of the extent that is in gaps below 2 eps

    /// Returns the mean of the three values: the continuity that landmarks report.
    [[nodiscard]] double mean() const noexcept { return (linearity + evenness + fill) / 3.0; }

    friend bool operator==(const Continuity&, const Continuity&) = default;
};

/// Computes the continuity of the points of one cluster, in any order.
///
/// Gaps are between successive points along the major axis; equal points have a gap of 0. The extent is the sum of the
/// gaps. The standard deviation is that of the gaps themselves (divided by their number). If no axis is the major one,
/// the x axis is used. Without extent (no point, one point, all points equal) all values are 0. Two points have one
/// gap, so their evenness is 1.
/// @param points  metres
/// @param eps     metres
/// Precondition: the points pass check_points(); eps > 0.
/// Cost: O(n log n).
[[nodiscard]] Continuity continuity_of(std::span<const Point2> points, double eps);

/// A thing in a room, as a lidar sees it: a piece of a wall, a cupboard, a door. Metres, in the frame of the points.
struct Landmark {
    Point2 position{0.0, 0.0}; ///< per-axis median of its points; not necessarily one of them
    std::size_t points = 0;    ///< of its cluster
    Point2 size{0.0, 0.0};     ///< its extent along x and along y
    double spread = 0.0;       ///< median distance of its points from the position
    double continuity = 0.0;   ///< Continuity::mean()

    friend bool operator==(const Landmark&, const Landmark&) = default;
};

/// Returns the positions of landmarks, for match().
[[nodiscard]] std::vector<Point2> positions_of(std::span<const Landmark> landmarks);

/// Settings of find_landmarks().
struct LandmarkSettings {
    std::size_t min_points = 5; ///< see dbscan()
    std::optional<double> eps;  ///< metres; nullopt: adaptive_eps()
};

/// The landmarks of a cloud, and how they were found.
struct LandmarkSurvey {
    std::vector<Landmark> landmarks; ///< one for each cluster, in the order of the clusters
    Clustering clustering;           ///< of the points
    double eps = 0.0;                ///< the eps that was used, metres
};

/// Finds the landmarks of a cloud, the points of one keyframe, and returns how they were found. Medians of an even
/// count are the mean of the middle two.
/// @param points    metres; without points there are no landmarks
/// @param settings  of the clustering
/// Errors: kInvalidField if eps or min_points is out of range (see dbscan()) or a point is invalid (see
///     check_points()).
/// Cost: O(n log n).
[[nodiscard]] Result<LandmarkSurvey> survey_landmarks(std::span<const Point2> points,
                                                      const LandmarkSettings& settings = {});

/// Finds the landmarks of a cloud, the points of one keyframe.
/// @param points    metres
/// @param settings  of the clustering
/// Errors: those of survey_landmarks().
[[nodiscard]] Result<std::vector<Landmark>> find_landmarks(std::span<const Point2> points,
                                                           const LandmarkSettings& settings = {});

} // namespace scanloom::landmarks
