#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace scanloom::landmarks {

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
