#pragma once

#include "lab/lidar_capture.hpp"

#include "common/error/error.hpp"

#include <filesystem>
#include <string>

namespace scanloom::lab {

/// A recording of a real lidar that stood still.
struct RecordedCapture {
    LidarCapture capture; ///< all poses 0: the map frame is the lidar's
    std::string name;     ///< of its file, without its directories
    std::string remarks;  ///< what the decoder says of it
};

/// The bytes that an LD06 sent, as its robot client decodes them by default.
/// Errors  those of robot::Ld06Capture; kInvalidField: less than two turns, which have no two halves to compare.
[[nodiscard]] Result<RecordedCapture> read_ld06_recording(const std::filesystem::path& path);

} // namespace scanloom::lab
