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
    Point2 position{0.0, 0.0}; ///< per axis the median of its points; it need not be at any of them
    std::size_t points = 0;
    Point2 size{0.0, 0.0};   ///< its extent along x and along y
    double spread = 0.0;     ///< the median distance of its points from the position
    double continuity = 0.0; ///< Continuity::mean()

    friend bool operator==(const Landmark&, const Landmark&) = default;
};

/// Where they are, for match().
[[nodiscard]] std::vector<Point2> positions_of(std::span<const Landmark> landmarks);

struct LandmarkSettings {
    std::size_t min_points = 5; ///< as dbscan() takes it
    std::optional<double> eps;  ///< metres; absent: adaptive_eps()
};

/// Landmarks, and how they were found.
struct LandmarkSurvey {
    std::vector<Landmark> landmarks; ///< one a cluster, in the order of their numbers
    Clustering clustering;
    double eps = 0.0; ///< that was used
};

/// The landmarks of a cloud: the points of one capture, or of a keyframe. Medians of an even count are the mean of the
/// middle two. No points have no landmarks.
///
/// Errors  kInvalidField: eps or min_points out of its range (see dbscan()), a point that is none (check_points()).
/// Cost    n log n.
[[nodiscard]] Result<LandmarkSurvey> survey_landmarks(std::span<const Point2> points,
                                                      const LandmarkSettings& settings = {});

/// The landmarks alone.
[[nodiscard]] Result<std::vector<Landmark>> find_landmarks(std::span<const Point2> points,
                                                           const LandmarkSettings& settings = {});

} // namespace scanloom::landmarks
