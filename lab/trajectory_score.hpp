#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"
#include "robot_client/sources/pose_path.hpp"

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

namespace scanloom::lab {

/// A verified relation: where a robot was at one time, relative to where it was at another.
struct Relation {
    double from_stamp = 0.0; ///< seconds
    double to_stamp = 0.0;   ///< seconds
    Pose2 T_from_to;         ///< pose of the robot at to_stamp, in its frame at from_stamp
};

/// Reads a file of relations (plain, gzip or bzip2). Each line is `t1 t2 x y z roll pitch yaw` in seconds, metres and
/// radians; z, roll and pitch are ignored. Blank lines and lines that begin with '#' are skipped.
/// Errors: those of robot::LineReader; kMalformed or kInvalidField if a line is not as above; the message contains its
///         number; kNotFound if there is no relation.
[[nodiscard]] Result<std::vector<Relation>> read_relations(const std::filesystem::path& path);

/// A stamp that is farther than this outside the trajectory has no pose.
inline constexpr double kStampOutsideMax = 0.5; // seconds

/// A stamp within this of a pose's stamp is that of the pose's scan.
inline constexpr double kSameStampMax = 1e-3; // seconds

/// Which relations count.
enum class RelationUse {
    kInterpolated, ///< all whose stamps are within the trajectory or kStampOutsideMax of it; poses are interpolated
    kOfScans,      ///< of these, those with a pose within kSameStampMax of each stamp. For trajectories without some of
                   ///< the log's scans: interpolation between distant poses would count as error.
};

/// Mean and standard deviation (of a sample: divided by n - 1). Both are 0 without values.
struct Spread {
    double mean = 0.0;
    double deviation = 0.0;
};

/// Errors of one kind, over all relations that count.
struct ErrorSpread {
    Spread absolute; ///< of the absolute errors: metres or degrees
    Spread squared;  ///< of the squared errors: square metres or square degrees
};

/// How well a trajectory agrees with relations.
struct TrajectoryScore {
    std::size_t used = 0;     ///< relations that count
    std::size_t missing = 0;  ///< relations with a stamp outside the trajectory
    std::size_t left_out = 0; ///< relations that do not count because of RelationUse::kOfScans
    ErrorSpread translation;  ///< metres
    ErrorSpread rotation;     ///< degrees
};

/// Compares a trajectory with relations. The error of a relation is the relative pose in the trajectory times the
/// inverse of the relation's. Source: Kuemmerle et al., On measuring the accuracy of SLAM algorithms, 2009.
/// @param trajectory  T_map_robot at stamps; any order
/// @param relations   verified relative poses of the same robot
/// Errors: kInvalidField if no relation counts.
[[nodiscard]] Result<TrajectoryScore> score_trajectory(std::vector<robot::StampedPose> trajectory,
                                                       std::span<const Relation> relations, RelationUse use);

} // namespace scanloom::lab
