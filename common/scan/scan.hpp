#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/beam_angles.hpp"
#include "common/scan/sensor.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace scanloom {

/// A reading in whole millimetres: one of the two marks below, or a length.
using RangeMm = std::uint32_t;
inline constexpr RangeMm kInvalidRange = 0;        ///< no valid reading
inline constexpr RangeMm kNoReturn = 0xFFFF'FFFFU; ///< nothing within the sensor's range_max

/// Rounds a reading once, where it enters the system (on the robot): NaN, zero and negative lengths
/// become kInvalidRange, +inf and lengths beyond 4,294,967 m kNoReturn.
[[nodiscard]] RangeMm to_range_mm(double range_m) noexcept;

/// The same of each reading of a scan: `scan.ranges = to_ranges_mm(metres)`.
[[nodiscard]] std::vector<RangeMm> to_ranges_mm(std::span<const float> ranges_m);
[[nodiscard]] std::vector<RangeMm> to_ranges_mm(std::span<const double> ranges_m);

/// One sweep of one sensor, taken from one pose. Metres and radians, counter-clockwise.
///
/// Frames  map: fixed, and one for all robots of a session; robot: x ahead, y to the left, its origin wherever its pose
///         is meant; odom: fixed where the odometry began. T_a_b is the pose of b in frame a.
struct Scan {
    std::uint64_t seq = 0;                  ///< per (session, robot), from 1, rising by 1; robot::Client numbers them
    double stamp = 0.0;                     ///< seconds since the epoch, or since the robot's own start
    std::uint32_t sensor = 0;               ///< Sensor::id
    Pose2 pose;                             ///< T_map_robot, as well as the robot knows: the map is woven from it
    std::optional<Pose2> odometry;          ///< T_odom_robot, kept for whoever corrects poses later
    std::vector<RangeMm> ranges;            ///< one a beam
    std::vector<std::uint32_t> intensities; ///< empty, or one a beam; the sensor's own scale
    std::optional<BeamAngles> angles;       ///< only where they differ from the sensor's
    bool begins_map = false; ///< people said the pose, nothing being mapped: to be taken only if that holds

    friend bool operator==(const Scan&, const Scan&) = default;
};

/// Where the beams of `scan` point: its own angles, or its sensor's, cut or continued to the
/// number of its ranges when they are uniform.
/// Pre  validated: explicit angles have one entry per range.
[[nodiscard]] BeamAngles angles_of(const Scan& scan, const Sensor& sensor);

} // namespace scanloom
