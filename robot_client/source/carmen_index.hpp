#pragma once

#include "robot_client/source/carmen_observation.hpp"
#include "robot_client/source/line_reader.hpp"
#include "robot_client/source/pose_path.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace scanloom::robot {

/// A line that could not be used, and the reason.
struct SkippedLine {
    std::size_t line_number = 0;
    std::string reason;
};

/// What the stamps of the scans show about their order, see ScanOrder.
struct StampReport {
    std::size_t steps_back = 0;
    double back_max = 0.0;  ///< seconds
    bool file_order = true; ///< whether scans are sent in the order of the file; otherwise by time
};

/// The data of a whole log that are needed before its first scan can be sent. They are small, so a log may be large.
struct CarmenIndex {
    /// For each laser line, in the order of the file: its index among the scans in sending order, from 0, or kUnused if
    /// the line is not sent.
    std::vector<std::uint32_t> places;
    static constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();

    std::uint32_t scan_count = 0;
    PosePath path; ///< only if the scans come from RAWLASER lines
    double laser_offset_forward = 0.0;
    std::size_t skipped_lines = 0;
    StampReport stamps;
    std::string fingerprint; ///< of the lines and options that determine the scans, and of their order
};

/// Reads a log once.
/// @param report   called for each malformed line in the order of the file, then once for each unread kind of laser
///                 line, then for each RAWLASER line without a pose
/// @param on_read  called after each chunk of the file
/// Errors: those of LineReader; kNotFound if no line is usable; kTooLarge if there are more than 2^32 - 2 laser lines.
[[nodiscard]] Result<CarmenIndex> index_carmen_log(const std::filesystem::path& path, const CarmenOptions& options,
                                                   const std::function<void(const SkippedLine&)>& report,
                                                   const OnRead& on_read = {});

} // namespace scanloom::robot
