#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"

#include <span>
#include <vector>

namespace scanloom::landmarks {

/// One place as two frames have it.
struct PointPair {
    Point2 first{0.0, 0.0};  ///< metres, in the first frame
    Point2 second{0.0, 0.0}; ///< metres, in the second frame
    double weight = 1.0;     ///< 0 or more; only the weights' ratios matter
};

/// The rigid transform that fits pairs best.
struct PairAlignment {
    Pose2 T_first_second;
    double rms = 0.0;              ///< metres, of the weighted distances that remain
    std::vector<std::size_t> used; ///< indices of the pairs that took part, rising
};

/// The rotation and translation, never a reflection, that make the weighted sum of squared distances between each first
/// and the transformed second least. Pairs of weight 0 take no part.
///
/// Two pairs are enough, and so are pairs on one line: in the plane only a reflection would fit those as well.
/// Errors  kInvalidField: a point (see check_points()); a weight that is negative or not finite; fewer than 2 pairs of
///         weight; a rotation that is not determined, as where all points of one side are equal.
/// Source  Umeyama, Least-squares estimation of transformation parameters between two point patterns (1991); in the
///         plane the rotation is the direction of the sum of conj(second) * first, both from their centroids.
[[nodiscard]] Result<PairAlignment> align_pairs(std::span<const PointPair> pairs);

/// The transform that pairs agree on within `inlier_distance`, however wrong the others are: truncated least squares.
/// What each two pairs give is tried (of more than 64 pairs, evenly chosen ones), and the best is fitted to all that
/// agree with it.
///
/// `used` are the pairs that agree, their rms is that of align_pairs() with them alone.
/// Errors  as align_pairs(), of points, weights and fewer than 2 pairs; kInvalidField also: an inlier distance that is
///         not finite and more than 0; fewer than 3 pairs that agree, as any 2 of like length do. kAmbiguous: others,
///         of four fifths of the weight or more, agree on another transform.
/// Cost    64 * 64 / 2 times the pairs, at most, twice.
/// Source  Fischler, Bolles, Random sample consensus (1981); with so few pairs none is left to chance.
[[nodiscard]] Result<PairAlignment> align_pairs_robustly(std::span<const PointPair> pairs, double inlier_distance);

} // namespace scanloom::landmarks
