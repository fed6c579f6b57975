#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"
#include "common/scan/limits.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::landmarks {

/// What a stationary lidar saw from one place in some turns.
struct CloudView {
    std::span<const Point2> points; ///< metres, in any frame
    Point2 from{0.0, 0.0};          ///< position of the sensor, in that frame
};

/// Settings of align().
struct AlignmentSettings {
    double distance_max = 5.0; ///< metres between the sensor positions of the two views, along each axis of the first
};

inline constexpr double kDistinctDistance = 0.1;   ///< metres; poses that differ by less are the same result
inline constexpr double kDistinctTurn = 0.0523599; ///< radians, 3 degrees

/// Whether an alignment can be relied on.
enum class Certainty {
    kClear,        ///< no other pose may be correct as well
    kAmbiguous,    ///< another pose may be correct as well; the pose given is one of several
    kUndetermined, ///< the views overlap too little to find the pose, or to find it accurately
};

/// The pose of one view relative to another, as found by scan matching.
struct Alignment {
    Pose2 T_first_second;                           ///< takes points of the second view's frame to the first's
    Certainty certainty = Certainty::kUndetermined; ///< result of the acceptance test; see test_acceptance()
    std::string why;                                ///< why the certainty is not kClear, a sentence; empty if it is
    std::optional<Pose2> competing_pose;            ///< the best of the other poses that may be correct as well

    /// Ratios, 0 to 1, of the second view's surface, in which every 10 cm count as one element.
    double inlier_ratio = 0.0;   ///< lies on a surface of the first view
    double outlier_ratio = 0.0;  ///< lies in the first view's free space; moved things or a wrong pose
    double rms = 0.0;            ///< metres, distance of the inliers from the lines of the first view
    double position_sigma = 0.0; ///< metres, of the second view's sensor position, in its least certain direction
    double yaw_sigma = 0.0;      ///< radians
};

/// Checks that a view can be matched.
/// @param name  the name of the view in error messages
/// @param view  points and sensor position in one frame, metres
/// Errors: kInvalidField if a point or the sensor position is invalid (see check_points()), or if the view has fewer
///     than kViewPointsMin points. The message contains the name.
[[nodiscard]] Result<> check_view(std::string_view name, const CloudView& view);

/// Finds the pose of one view relative to another view of the same place, without an initial guess.
///
/// Searches all poses, refines the best hypotheses, and tests them against what both views saw and against the free
/// space that they observed. The certainty of the result is:
/// - kAmbiguous if another pose, more than kDistinctDistance or kDistinctTurn away, has nearly as many inliers (a room
///   that is almost symmetric) and at most one thing distinguishes the two poses; or if another pose has fewer inliers
///   but also fewer outliers; or if nothing constrains the pose in some direction (a corridor, along its axis).
/// - kUndetermined if the views overlap little, if there are many outliers, or if the position is less certain than
///   2 cm (3 position_sigma).
///
/// A pose is returned in each case, for display. No alignment can show that two views are of the same place, because
/// rooms may be equal. The sigmas are those of the fit, from its residuals and the directions of the surfaces; they do
/// not include things that moved or other poses.
/// @param first     view in whose frame the pose is returned, metres
/// @param second    view whose pose is searched, metres
/// @param settings  limits of the search
/// Errors: those of check_view(); kInvalidField if distance_max is not more than 0 and at most 100.
/// Cost: O(n log n) of the points, and some tens of milliseconds.
/// Source: the steps are find_hypotheses(), refine_by_icp(), fit_to_lines() and test_acceptance().
[[nodiscard]] Result<Alignment> align(const CloudView& first, const CloudView& second,
                                      const AlignmentSettings& settings = {});

} // namespace scanloom::landmarks
