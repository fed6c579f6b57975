#pragma once

#include "common/geometry/pose2.hpp"
#include "server/foxglove/cdr_writer.hpp"

#include <cstdint>
#include <string_view>

/// Fields that many messages of ROS 2 have.
namespace scanloom::foxglove {

inline constexpr std::uint64_t kNanoseconds = 1'000'000'000; ///< of a second

/// Returns a stamp in nanoseconds since the epoch or the robot's own start, as the log time of a message.
/// @param stamp  seconds; a negative one counts as 0
[[nodiscard]] std::uint64_t log_time_of(double stamp) noexcept;

/// Adds a builtin_interfaces/Time.
/// @param stamp  seconds, as for log_time_of(); at most 2^31 - 1
void add_time(double stamp, CdrWriter& message);

/// Adds a std_msgs/Header.
void add_header(double stamp, std::string_view frame, CdrWriter& message);

/// Adds a geometry_msgs/Pose or geometry_msgs/Transform: metres and a unit quaternion.
void add_pose(const Pose2& pose, CdrWriter& message);

} // namespace scanloom::foxglove
