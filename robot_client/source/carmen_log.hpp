#pragma once

#include "common/error/error.hpp"
#include "robot_client/source/line_reader.hpp"
#include "robot_client/source/source.hpp"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::robot {

struct CarmenOptions {
    /// Default: kFree where the log states its sensor's range (ROBOTLASER, RAWLASER), kDrop where it does not (FLASER).
    std::optional<NoReturn> no_return;
    /// Metres; readings of this length or more are no-return. Default: what the log states, at most kCarmenRangeMax.
    std::optional<double> range_max;
    LineLimits limits;
};

/// Logs write "no return" as 50, 80, 81.83, 81.91 ...: from 50 m on a reading is one, unless the user says otherwise.
inline constexpr double kCarmenRangeMax = 50.0;

/// A line that could not be used, and why.
struct SkippedLine {
    std::size_t line_number = 0;
    std::string reason;
};

struct CarmenLog {
    std::vector<Observation> observations; ///< by rising stamp; those of one stamp in the order of the file
    std::size_t skipped_lines = 0;
};

/// Reads the laser lines of a CARMEN log (plain, gzip or bzip2) and puts them in the order of their ipc_timestamp:
/// the order of a file is not always that of time. A line without a time stamp takes that of the line before it.
///
/// FLASER   scan.pose is the first triple (laser pose, often corrected) and the mount is the identity;
///          scan.odometry is the second triple.
/// ROBOTLASER   the mount is the laser's pose in the robot's; it is kept while it changes by rounding only, and
///          scan.pose is chosen so that pose * mount is the laser pose as logged.
/// RAWLASER1   carries no pose and is read only where the log has no other laser lines: the pose is interpolated
///          between the ODOM lines around it, the mount is PARAM robot_frontlaser_offset.
/// Ranges   rounded to millimetres here, once; NaN, infinite and negative readings are invalid beams.
///
/// `report` hears of every line that cannot be used, in the order in which they are found.
/// Errors  those of LineReader; kNotFound when no line is usable. Each names the file and a line.
[[nodiscard]] Result<CarmenLog> read_carmen_log(const std::filesystem::path& path, const CarmenOptions& options,
                                                const std::function<void(const SkippedLine&)>& report);

} // namespace scanloom::robot
