#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"
#include "core/landmarks/cloud_fusion.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::landmarks {

inline constexpr std::size_t kViewPointsMin = 20; ///< points that a view needs to be matched

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
    Certainty certainty = Certainty::kUndetermined; ///< result of the acceptance test; see judge()
    std::string why;                                ///< why the certainty is not kClear, a sentence; empty if it is
    std::optional<Pose2> rival;                     ///< the best of the other poses that may be correct as well

    /// Ratios, 0 to 1, of the second view's surface, in which every 10 cm count as one element.
    double explained = 0.0;      ///< inlier ratio: lies on a surface of the first view
    double contradicted = 0.0;   ///< outlier ratio: lies in the first view's free space; moved things or a wrong pose
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
/// Source: the steps are find_hypotheses(), settle(), fit_to_lines() and judge().
[[nodiscard]] Result<Alignment> align(const CloudView& first, const CloudView& second,
                                      const AlignmentSettings& settings = {});

/// The positions of one place in two frames.
struct PointPair {
    Point2 first{0.0, 0.0};  ///< metres, in the first frame
    Point2 second{0.0, 0.0}; ///< metres, in the second frame
    double weight = 1.0;     ///< 0 or more; only the weights' ratios matter
};

/// The rigid transform that fits pairs best, in the least-squares sense.
struct PairAlignment {
    Pose2 T_first_second;          ///< takes second points to first ones: metres, radians
    double rms = 0.0;              ///< metres, weighted, of the remaining distances
    std::vector<std::size_t> used; ///< indices of the pairs that were used, ascending
};

/// Computes the rotation and translation, never a reflection, that minimize the weighted sum of squared distances
/// between each first point and the transformed second point.
///
/// Pairs of weight 0 are ignored. Two pairs are enough, and so are pairs on one line: in the plane only a reflection
/// would fit those as well.
/// @param pairs  positions and weights, metres
/// Errors: kInvalidField for an invalid point (see check_points()), a weight that is negative or not finite, fewer than
///     2 pairs with weight, or a rotation that is not determined, for example if all points of one side are equal.
/// Source: Umeyama, Least-squares estimation of transformation parameters between two point patterns (1991); in the
///     plane the rotation is the direction of the sum of conj(second) * first, both relative to their centroids.
[[nodiscard]] Result<PairAlignment> align_pairs(std::span<const PointPair> pairs);

/// Computes the transform on which most pairs agree, however wrong the others are (truncated least squares).
///
/// Each combination of two pairs gives a transform to test (of more than 64 pairs, evenly chosen ones are combined).
/// The best transform is fitted to all pairs that agree with it. `used` contains the pairs that agree; their rms is
/// that of align_pairs() with these pairs alone.
/// @param pairs            positions and weights, metres
/// @param inlier_distance  metres within which a pair agrees with a transform
/// Errors: kInvalidField for an invalid point or weight or fewer than 2 pairs with weight, as align_pairs(), for an
///     inlier distance that is not finite and more than 0, or if fewer than 3 pairs agree (any 2 of similar length do);
///     kAmbiguous if other pairs, of four fifths of the weight or more, agree on another transform.
/// Cost: at most 64 * 64 / 2 times the number of pairs, twice.
/// Source: Fischler, Bolles, Random sample consensus (1981); pairs are few enough to test all combinations instead of
///     random ones.
[[nodiscard]] Result<PairAlignment> align_pairs_robustly(std::span<const PointPair> pairs, double inlier_distance);

} // namespace scanloom::landmarks
