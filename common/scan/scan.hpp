#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/beam_angles.hpp"
#include "common/scan/sensor.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace scanloom {

/// A reading in whole millimetres, or one of the two special values below.
using RangeMm = std::uint32_t;
inline constexpr RangeMm kInvalidRange = 0;        ///< no valid reading
inline constexpr RangeMm kNoReturn = 0xFFFF'FFFFU; ///< nothing within the sensor's range_max

/// Rounds a reading in metres to millimetres. Readings are rounded once, where they enter the system (on the robot).
/// @param range_m  metres, from the sensor; any value
/// @return kInvalidRange for NaN, zero and negative lengths; kNoReturn for +inf and lengths beyond 4,294,967 m
[[nodiscard]] RangeMm to_range_mm(double range_m) noexcept;

/// Applies to_range_mm() to each reading of a scan: `scan.ranges = to_ranges_mm(metres)`.
/// @param ranges_m  metres, one per beam
/// @return the readings in the same order
[[nodiscard]] std::vector<RangeMm> to_ranges_mm(std::span<const float> ranges_m);
/// Applies to_range_mm() to each reading of a scan.
/// @param ranges_m  metres, one per beam
/// @return the readings in the same order
[[nodiscard]] std::vector<RangeMm> to_ranges_mm(std::span<const double> ranges_m);

/// One sweep of one sensor, taken from one pose. Metres and radians, counter-clockwise.
///
/// Frames: map is fixed and common to all robots of a session. robot has x ahead and y to the left; its origin is the
///         point that the robot's pose refers to. odom is fixed where the odometry began. T_a_b is the pose of b in
///         frame a.
struct Scan {
    std::uint64_t seq = 0;     ///< per (session, robot), from 1, rising by 1; robot::Client assigns it
    double stamp = 0.0;        ///< seconds since the epoch, or since the robot's own start
    double duration = 0.0;     ///< seconds from the first beam to the last if the laser turns meanwhile; the stamp is
                               ///< that of the middle. Negative: the last beam was taken first; 0: not known, or all
                               ///< beams were taken at once
    std::uint32_t sensor = 0;  ///< Sensor::id
    std::optional<Pose2> pose; ///< T_map_robot; nullopt: the server estimates it (see Poses), or cannot
    std::optional<Pose2> odometry;          ///< T_odom_robot, from which the server predicts poses that it estimates
    std::vector<RangeMm> ranges;            ///< one per beam
    std::vector<std::uint32_t> intensities; ///< empty, or one per beam; the sensor's own scale
    std::optional<BeamAngles> angles;       ///< only if they differ from the sensor's
    bool begins_map = false; ///< people chose the pose because nothing was mapped; rejected if something is

    friend bool operator==(const Scan&, const Scan&) = default;
};

/// Returns the directions of the beams of `scan`: its own angles, or its sensor's. Uniform angles of the sensor are
/// shortened or continued to the number of ranges.
/// @param scan    a scan that `sensor` took
/// @param sensor  its angles are used if the scan has none
/// @return radians in the sensor frame, one direction per range
/// Precondition: the scan is validated: explicit angles have one entry per range.
[[nodiscard]] BeamAngles angles_of(const Scan& scan, const Sensor& sensor);

} // namespace scanloom
