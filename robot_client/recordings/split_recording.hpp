#pragma once

#include "robot_client/recordings/recording.hpp"

#include <filesystem>
#include <memory>
#include <vector>

namespace scanloom::robot {

/// Lists the files of a recording in a directory, as rosbag2 writes it: the only recording in it, or the parts into
/// which the recorder has split it, in their order: files whose names end in consecutive numbers and differ in digits
/// only.
/// @param directory  its files are recognized by their names: .bag, .db3 and .mcap
/// Errors: kNotFound if it has no recording or cannot be read; kInvalidField if it has several that are not parts of one.
[[nodiscard]] Result<std::vector<std::filesystem::path>> parts_in(const std::filesystem::path& directory);

/// Opens the parts of a recording as one. A later part that cannot be opened is reported as a loss.
/// @param parts  at least one
/// Errors: those of open_recording() of the first part.
[[nodiscard]] Result<std::unique_ptr<Recording>> open_parts(std::vector<std::filesystem::path> parts);

} // namespace scanloom::robot
