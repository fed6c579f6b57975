#pragma once

#include "common/scan/poses.hpp"
#include "lab/perturbed_source.hpp"
#include "robot_client/sources/pose_path.hpp"

#include <cstddef>
#include <string>
#include <vector>

/// Changes to a log that must not matter, and how much they do.
namespace scanloom::lab {

/// How a log is estimated.
struct Variant {
    Poses poses = Poses::kOdometry; ///< kOdometry or kNone
    Perturbation perturbation;
};

/// Returns the variants by which the robustness of an estimate is judged: the odometry scaled by 0.97 to 1.03 with the
/// whole log, with the start cut off at two places and with every second scan; and without odometry, the start cut off
/// at six places. The places are multiples of a twentieth of the log, rounded up to one digit (681.5 scans: 700).
/// @param scans  of the log
/// @return 30 variants
[[nodiscard]] std::vector<Variant> variants_of(std::size_t scans);

/// Formats a variant: "odometry x 0.97, without the first 700 scans".
[[nodiscard]] std::string text_of(const Variant& variant);

/// A scan that is turned by more than this, in degrees, counts as turned.
inline constexpr double kTurned = 5.0;

/// How far a trajectory is from another one.
struct TrajectoryDistance {
    double metres = 0.0;          ///< the largest of any scan
    double degrees = 0.0;         ///< the largest turn of any scan, which may be another one
    std::size_t turned_scans = 0; ///< by more than kTurned
};

/// A trajectory with a scan that is farther than this from that of the log without changes has a false loop. The limit
/// of turns is that large because single scans are turned where their matches are doubtful.
inline constexpr double kFalseLoopMetres = 0.5;
inline constexpr double kFalseLoopDegrees = 15.0;

[[nodiscard]] inline bool is_false_loop(const TrajectoryDistance& distance) {
    return distance.metres > kFalseLoopMetres || distance.degrees > kFalseLoopDegrees;
}

/// Returns the poses of the scans that a perturbation leaves.
/// @param whole  of each scan of the log
[[nodiscard]] std::vector<robot::StampedPose> part_of(const std::vector<robot::StampedPose>& whole,
                                                      const Perturbation& perturbation);

/// Returns the distance of a trajectory from a reference, scan by scan, after the rigid motion that lays it on the
/// reference with the least squares of the distances.
/// @param reference  T_map_robot of some scans
/// @param poses      of the same scans, in any other frame
[[nodiscard]] TrajectoryDistance distance_between(const std::vector<robot::StampedPose>& reference,
                                                  const std::vector<robot::StampedPose>& poses);

} // namespace scanloom::lab
