#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"

namespace scanloom::scan_matching {

/// How a robot moved between two moments.
struct Motion {
    Pose2 T_before_now;   ///< the later pose in the frame of the earlier one
    double seconds = 0.0; ///< between the two moments; 0: not known

    friend bool operator==(const Motion&, const Motion&) = default;
};

/// Returns whether the beams of a scan have times (Scan::duration) and a motion says where the robot was then.
/// @param scan    its angles rise or fall from the first beam to the last; otherwise times are not known
/// @param sensor  that took it
/// @param motion  false if it took no time or more than 1 s, or was faster than 10 m/s or 10 rad/s: such a
///                jump is not used
/// Precondition: the scan is validated: explicit angles have one entry per range.
[[nodiscard]] bool can_deskew(const Scan& scan, const Sensor& sensor, const Motion& motion);

/// Returns the scan that the laser would have taken if the robot had stood still at the scan's stamp: each hit is where
/// its beam hit, seen from the pose at the stamp. Beams without a return are only turned. The result has angles of its
/// own and no duration. Equal inputs give equal bits on every processor.
///
/// The robot is assumed to move along an arc at an even speed, and the laser to turn at an even speed. A hit's range is
/// rounded to millimetres again.
/// Source: own.
/// @param scan    as taken
/// @param sensor  the laser that took it, with its mount
/// @param motion  of the robot around the time of the scan
/// Precondition: can_deskew(scan, sensor, motion).
[[nodiscard]] Scan deskewed(const Scan& scan, const Sensor& sensor, const Motion& motion);

} // namespace scanloom::scan_matching
