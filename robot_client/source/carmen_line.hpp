#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"
#include "common/scan/scan.hpp"
#include "robot_client/source/pose_path.hpp"

#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

namespace scanloom::robot {

enum class CarmenKind { kFlaser, kRobotLaser, kRawLaser };

/// One laser line as written, its readings rounded. Metres, radians, seconds.
struct CarmenScan {
    CarmenKind kind = CarmenKind::kFlaser;
    std::uint32_t sensor = 0;        ///< 0 front (FLASER, ROBOTLASER1, RAWLASER1), 1 rear (ROBOTLASER2)
    UniformAngles angles;            ///< first beam on the right, counter-clockwise
    std::optional<double> range_max; ///< what the line states; FLASER states nothing
    std::vector<RangeMm> ranges;     ///< what is no finite length is kInvalidRange: in a log that is a failed reading
    Pose2 laser;                     ///< FLASER: first triple; ROBOTLASER: laser pose; RAWLASER: not given
    Pose2 robot;                     ///< FLASER: second triple (odometry); ROBOTLASER: robot pose; RAWLASER: not given
    std::optional<double> stamp;     ///< ipc_timestamp, else logger_timestamp, else nothing
};

using CarmenOdometry = StampedPose;

/// PARAM robot_frontlaser_offset: metres from the robot's centre forward to the front laser.
struct CarmenLaserOffset {
    double forward = 0.0;
};

/// A laser line of a kind that is not read: RLASER, LASER3 to LASER5, RAWLASER2 to RAWLASER5.
struct CarmenUnreadLaser {
    std::string_view kind; ///< valid for ever
};

/// std::monostate: a comment, or a line that tells nothing of a laser.
using CarmenLine = std::variant<std::monostate, CarmenScan, CarmenOdometry, CarmenLaserOffset, CarmenUnreadLaser>;

/// Reads one line of a CARMEN log.
///
/// FLASER lines carry no angles. The lasers of those logs look from -90 degrees counter-clockwise:
/// 180 or 181 beams are 1 degree apart, 360 or 361 half a degree (180 beams end at +89, not at +90);
/// any other number of beams is spread evenly from -90 to +90 degrees, both included; one beam looks ahead.
/// ROBOTLASER lines are told apart by the number of values behind their ranges, because some lack
/// the count of remissions or turn_axis; the trailer (ipc_timestamp hostname logger_timestamp) may lack
/// its first value or be absent. Remissions are read over.
///
/// Errors  kMalformed: not what its tag promises; kInvalidField, kTooLarge: a value the map could not use.
///         Only laser lines have errors; other lines that cannot be read count as not read.
/// Source  CARMEN, logger_playback and writelog.
[[nodiscard]] Result<CarmenLine> parse_carmen_line(std::string_view line);

} // namespace scanloom::robot
