#pragma once

#include "common/error/error.hpp"
#include "robot_client/source/carmen_index.hpp"
#include "robot_client/source/line_reader.hpp"
#include "robot_client/source/pose_timeline.hpp"

#include <filesystem>
#include <functional>
#include <istream>
#include <optional>
#include <string_view>

/// Poses as text, a line each: `t x y yaw`, in seconds, metres and radians counter-clockwise, beyond a full turn, too, as
/// odometry counts; what stands behind is ignored, and so are blank lines and those that begin with '#'.
namespace scanloom::robot {

/// Nothing for a line that says nothing.
/// Errors  kMalformed, kInvalidField: not as above, not finite, or beyond kCoordinateMax.
[[nodiscard]] Result<std::optional<StampedPose>> read_pose_line(std::string_view line);

struct PoseLines {
    PoseTimeline poses;
    std::size_t skipped = 0; ///< lines that could not be used
};

/// Reads all of a file; `report` hears of every line that cannot be used.
/// Errors  those of LineReader; kNotFound: no line is usable.
[[nodiscard]] Result<PoseLines> read_pose_lines(const std::filesystem::path& path,
                                                const std::function<void(const SkippedLine&)>& report,
                                                LineLimits limits = {});

/// The same of a stream of bytes, which `name` calls for people.
[[nodiscard]] Result<PoseLines> read_pose_lines(std::istream& lines, std::string_view name,
                                                const std::function<void(const SkippedLine&)>& report);

} // namespace scanloom::robot
