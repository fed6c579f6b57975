#pragma once

#include "common/geometry/pose2.hpp"

#include <optional>
#include <string>

namespace scanloom::landmarks {

/// Whether an alignment can be relied on.
enum class Certainty {
    kClear,        ///< no other pose may be correct as well
    kAmbiguous,    ///< another pose may be correct as well; the pose given is one of several
    kUndetermined, ///< the view overlaps the map too little to find the pose, or to find it accurately
};

/// The pose of a view in a map, as found by scan matching. The map is the first of the two surfaces, the view the
/// second.
///
/// No alignment can show that a view is of a mapped place, because rooms may be equal. The sigmas are those of the fit,
/// from its residuals and the directions of the surfaces; they do not include things that moved or other poses.
struct Alignment {
    Pose2 T_first_second;                           ///< takes points of the view's frame to the map's
    Certainty certainty = Certainty::kUndetermined; ///< result of the acceptance test; see test_acceptance()
    std::string why;                                ///< why the certainty is not kClear, a sentence; empty if it is
    std::optional<Pose2> competing_pose;            ///< the best of the other poses that may be correct as well

    /// Ratios, 0 to 1, of the view's surface, in which every 10 cm count as one element.
    double inlier_ratio = 0.0;   ///< lies on a surface of the map
    double outlier_ratio = 0.0;  ///< lies in the map's free space; moved things or a wrong pose
    double rms = 0.0;            ///< metres, distance of the inliers from the lines of the map
    double position_sigma = 0.0; ///< metres, of the sensor position, in its least certain direction
    double yaw_sigma = 0.0;      ///< radians
};

} // namespace scanloom::landmarks
