#pragma once

#include "common/error/error.hpp"
#include "server/landmarks/clustering.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace scanloom::landmarks {

/// A thing in a room, as a lidar sees it: a piece of a wall, a cupboard, a door. Metres, in the frame of the points.
struct Landmark {
    Point2 position{0.0, 0.0}; ///< per-axis median of its points; not necessarily one of them
    std::size_t points = 0;
    Point2 size{0.0, 0.0};   ///< its extent along x and along y
    double spread = 0.0;     ///< median distance of its points from the position
    double continuity = 0.0; ///< Continuity::mean()

    friend bool operator==(const Landmark&, const Landmark&) = default;
};

/// Returns the positions of landmarks, for match().
[[nodiscard]] std::vector<Point2> positions_of(std::span<const Landmark> landmarks);

struct LandmarkSettings {
    std::size_t min_points = 5; ///< see dbscan()
    std::optional<double> eps;  ///< metres; nullopt: adaptive_eps()
};

/// The landmarks of a cloud, and how they were found.
struct LandmarkSurvey {
    std::vector<Landmark> landmarks; ///< one for each cluster, in the order of the clusters
    Clustering clustering;
    double eps = 0.0; ///< the eps that was used, metres
};

/// Finds the landmarks of a cloud, the points of one keyframe, and returns how they were found. Medians of an even
/// count are the mean of the middle two.
/// @param points  metres; without points there are no landmarks
/// Errors: kInvalidField if eps or min_points is out of range (see dbscan()) or a point is invalid (see
///     check_points()).
/// Cost: O(n log n).
[[nodiscard]] Result<LandmarkSurvey> survey_landmarks(std::span<const Point2> points,
                                                      const LandmarkSettings& settings = {});

/// Finds the landmarks of a cloud, the points of one keyframe.
/// @param points  metres
/// Errors: those of survey_landmarks().
[[nodiscard]] Result<std::vector<Landmark>> find_landmarks(std::span<const Point2> points,
                                                           const LandmarkSettings& settings = {});

} // namespace scanloom::landmarks
