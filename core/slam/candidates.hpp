#pragma once

#include "core/slam/keyframe_map.hpp"

#include <optional>
#include <vector>

namespace scanloom::slam {

/// Where the next scan is expected, relative to the newest keyframe.
struct Prediction {
    Transform2 last;                    ///< T_keyframe_robot at the last scan
    Transform2 velocity;                ///< T_last_robot if the robot moves as between the last two scans
    std::optional<Transform2> odometry; ///< T_last_robot by the odometry; nullopt: there is none
    double position_mismatch = 0.0;     ///< metres, mean distance of recent predictions from the matched poses
    double yaw_mismatch = 0.0;          ///< radians, likewise

    /// Returns T_last_robot by the odometry, else by the velocity.
    [[nodiscard]] const Transform2& motion() const noexcept { return odometry ? *odometry : velocity; }
};

/// A scan's pose, relative to the keyframe that was the newest when the scan was taken.
struct TrackedScan {
    Transform2 T_keyframe_robot; ///< as matched, or as predicted
    double inlier_ratio = 0.0;   ///< of the scan's points; 0 if it was not matched
    bool is_matched = false;     ///< whether the scan fitted the map; otherwise the pose is a prediction
    double position_sigma = 0.0; ///< metres, standard deviation in the most uncertain direction
    double yaw_sigma = 0.0;      ///< radians, standard deviation
    double conditioning = 0.0;   ///< see LineMatch; 0 if it was not matched
};

/// A place where a scan may have been taken.
struct Candidate {
    TrackedScan scan;   ///< if it was taken there
    double value = 0.0; ///< agreement with the map minus a penalty for the distance from the prediction
};

/// How carefully candidates_of() looks.
enum class Care {
    kOneIfPlain, ///< one candidate with a value of 0 if nothing is doubtful
    kValued,     ///< candidates have values, to be compared with those of other predictions
};

/// Returns where a scan may have been taken. One candidate if the match near the prediction is good and odometry and
/// velocity agree. Otherwise those of several starts and priors, because odometry can be wrong (wheels slip, or count
/// backwards when they reverse), and, as the last one, the prediction itself: the scan may show people only.
/// Source: own; each start is refined by match_to_lines().
/// @param scan        its points
/// @param map         in the newest keyframe's frame
/// @param prediction  where the scan is expected
/// @param care        whether one plain candidate is enough
/// @return at least one candidate. Matches differ by 4 cm or 0.02 rad; the prediction may be close to one
/// Threads: one at a time for each map, which computes its space when it is first needed.
[[nodiscard]] std::vector<Candidate> candidates_of(const ScanPoints& scan, KeyframeMap& map,
                                                   const Prediction& prediction, Care care);

} // namespace scanloom::slam
