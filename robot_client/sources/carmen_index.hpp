#pragma once

#include "robot_client/sources/carmen_record.hpp"
#include "robot_client/sources/line_reader.hpp"
#include "robot_client/sources/pose_path.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace scanloom::robot {

/// Stamps that go back by at most this are jitter. A log whose stamps go back by more has parts out of order.
inline constexpr double kStampJitterMax = 2.0; // seconds

/// The order in which the scans of a log are sent.
struct ScanOrder {
    std::vector<std::uint32_t> order; ///< indices of the scans
    std::size_t steps_back = 0;       ///< scans with a smaller stamp than the scan before in the file
    double back_max = 0.0;            ///< the farthest that a stamp lies behind the newest one before it, seconds
    bool is_of_file = true;
    bool is_of_stamps = true; ///< whether no stamp goes back in this order
};

/// Computes the order of a log's scans. Scans keep the order of the file if their stamps only jitter: that is the order
/// in which they were taken, and sorting would make the robot jump back and forth. Where a stamp lies more than
/// kStampJitterMax behind the newest one before it, a new part begins. The parts are then ordered by time (stable);
/// within each part, jitter still changes nothing.
/// Pre: stamps are finite, fewer than 2^32.
[[nodiscard]] ScanOrder order_of(std::span<const double> stamps);

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
