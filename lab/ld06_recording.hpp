#pragma once

#include "lab/lidar_capture.hpp"

#include "common/error/error.hpp"

#include <filesystem>
#include <string>

namespace scanloom::lab {

/// A recording of a real, stationary lidar.
struct RecordedCapture {
    LidarCapture capture; ///< all poses are 0: the map frame is the lidar's
    std::string name;     ///< file name without directories
    std::string remarks;  ///< what the decoder reports
};

/// Reads the bytes that an LD06 sent, decoded as by its robot client with default settings.
/// Errors: those of robot::Ld06Capture; kInvalidField: fewer than two turns, so there are no two halves to compare.
[[nodiscard]] Result<RecordedCapture> read_ld06_recording(const std::filesystem::path& path);

} // namespace scanloom::lab
