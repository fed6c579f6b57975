#pragma once

#include "common/error/error.hpp"
#include "robot_client/sources/carmen_index.hpp"
#include "robot_client/sources/line_reader.hpp"
#include "robot_client/sources/pose_path.hpp"

#include <filesystem>
#include <functional>
#include <istream>
#include <optional>
#include <string_view>

/// Reads poses from text, one per line: `t x y yaw` in seconds, metres and radians counter-clockwise. The yaw may
/// exceed a full turn, as odometry counts it. Text after these values, blank lines and lines that begin with '#' are
/// ignored.
namespace scanloom::robot {

/// Parses one line; returns nullopt for a blank line or comment.
/// Errors: kMalformed or kInvalidField if the line is not as above, not finite, or beyond kCoordinateMax.
[[nodiscard]] Result<std::optional<StampedPose>> read_pose_line(std::string_view line);

struct PoseLines {
    PoseTimeline poses;
    std::size_t skipped = 0; ///< lines that could not be used
};

/// Reads a whole file.
/// @param report  called for each line that cannot be used
/// Errors: those of LineReader; kNotFound if no line is usable.
[[nodiscard]] Result<PoseLines> read_pose_lines(const std::filesystem::path& path,
                                                const std::function<void(const SkippedLine&)>& report,
                                                LineLimits limits = {});

/// Reads a whole stream. `name` identifies it in messages. Errors: as for a file.
[[nodiscard]] Result<PoseLines> read_pose_lines(std::istream& lines, std::string_view name,
                                                const std::function<void(const SkippedLine&)>& report);

} // namespace scanloom::robot
