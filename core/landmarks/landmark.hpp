#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"
#include "core/landmarks/clustering.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace scanloom::landmarks {

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

inline constexpr double kTolerance = 0.25; ///< metres

/// Points of two sets that are each other's nearest neighbours.
struct Match {
    std::size_t first;  ///< index in the first set
    std::size_t second; ///< index in the second set
    double distance;    ///< metres

    friend bool operator==(const Match&, const Match&) = default;
};

/// Finds mutual nearest neighbours of two sets in one frame.
///
/// Of several nearest points the one with the lowest index counts. So each point is in at most one match, and of equal
/// points in one set only the first can be matched.
/// @param first      metres
/// @param second     metres, in the same frame
/// @param tolerance  metres; matched points are at most this far apart
/// @return the matches in the order of `first`; empty if a set is empty
/// Errors: kInvalidField if the tolerance is negative or not finite; those of check_points().
/// Cost: O(n log n) of the points.
[[nodiscard]] Result<std::vector<Match>> match(std::span<const Point2> first, std::span<const Point2> second,
                                               double tolerance = kTolerance);

/// How consistent two sets of landmarks are. A value is nullopt if it would be divided by 0.
struct Metrics {
    std::size_t matched = 0;             ///< number of matches
    std::optional<double> persistence;   ///< fraction of the first set's landmarks that are matched
    std::optional<double> stability;     ///< fraction of the matches at most half the tolerance apart
    std::optional<double> distance_mean; ///< metres, of the matches
    std::optional<double>
        distance_sigma; ///< metres, standard deviation of the matches' distances, divided by their number
};

/// Computes how consistent two sets of landmarks are.
/// @param matches      the result of match() with `tolerance`
/// @param first_count  number of landmarks of the first set
/// @param tolerance    metres
/// Precondition: there are no more matches than first_count.
[[nodiscard]] Metrics metrics_of(std::span<const Match> matches, std::size_t first_count,
                                 double tolerance = kTolerance);

} // namespace scanloom::landmarks
