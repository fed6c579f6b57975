#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"
#include "common/scan/scan.hpp"
#include "robot_client/sources/pose_path.hpp"

#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

namespace scanloom::robot {

enum class CarmenKind { kFlaser, kRobotLaser, kRawLaser };

/// One laser line as written, with rounded readings. Metres, radians, seconds.
struct CarmenScan {
    CarmenKind kind = CarmenKind::kFlaser;
    std::uint32_t sensor = 0;        ///< 0 front (FLASER, ROBOTLASER1, RAWLASER1), 1 rear (ROBOTLASER2)
    UniformAngles angles;            ///< first beam on the right, then counter-clockwise
    std::optional<double> range_max; ///< as the line states; FLASER states none
    std::vector<RangeMm> ranges;     ///< a value that is not a finite length, a failed reading, is kInvalidRange
    Pose2 laser;                     ///< FLASER: first triple; ROBOTLASER: laser pose; RAWLASER: not given
    Pose2 robot;                     ///< FLASER: second triple (odometry); ROBOTLASER: robot pose; RAWLASER: not given
    std::optional<double> stamp;     ///< ipc_timestamp, else logger_timestamp, else none
};

using CarmenOdometry = StampedPose;

/// PARAM robot_frontlaser_offset: metres from the robot's centre forward to the front laser.
struct CarmenLaserOffset {
    double forward = 0.0;
};

/// A laser line of a kind that is not read: RLASER, LASER3 to LASER5, RAWLASER2 to RAWLASER5.
struct CarmenUnreadLaser {
    std::string_view kind; ///< of static storage
};

/// std::monostate: a comment, or a line without laser data.
using CarmenLine = std::variant<std::monostate, CarmenScan, CarmenOdometry, CarmenLaserOffset, CarmenUnreadLaser>;

/// Parses one line of a CARMEN log.
///
/// FLASER lines contain no angles. The lasers of those logs scan counter-clockwise from -90 degrees: 180 or 181 beams
/// are 1 degree apart, 360 or 361 beams half a degree (180 beams end at +89, not at +90). Any other number of beams is
/// spread evenly from -90 to +90 degrees, both included; a single beam points ahead. ROBOTLASER lines are distinguished
/// by the number of values after their ranges, because some lack the count of remissions or turn_axis. The trailer
/// (ipc_timestamp hostname logger_timestamp) may lack its first value or be absent. Remissions are skipped.
///
/// Errors: kMalformed if the line does not have the format of its tag; kInvalidField or kTooLarge if the map could not
///         use a value. Only laser lines have errors; other lines that cannot be parsed count as not read.
/// Source: CARMEN, logger_playback and writelog.
[[nodiscard]] Result<CarmenLine> parse_carmen_line(std::string_view line);

} // namespace scanloom::robot
