#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_entry.hpp"
#include "common/scan/scan_filter.hpp"

#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::exchange {

/// Converts a session's log to a CARMEN log: a comment at the head, then a ROBOTLASER1 line for each scan, in the order
/// of the log. Replaying it into a session with the same settings gives the same maps, bit for bit. The format
/// has no times of beams: maps of de-skewed scans (Scan::duration) come out skewed.
///
/// Both poses of a line are the sensor's pose in the map, which the maps are made from. The robot's pose is not used
/// because the sensor's pose would have to be recomputed from it through the mount, and rounding would move cells.
/// Numbers have as many digits as reading the same value again needs; ranges are in metres with three decimals. A beam
/// without a return is written as the sensor's range_max, an invalid reading as 0.
///
/// The host name is the robot's name; both stamps are those of the scan. Readers sort lines by stamp. A scan whose
/// stamp goes back further than readers allow (robots whose clocks differ) therefore gets the latest stamp before it,
/// and a comment with its own stamp.
/// Source: CARMEN's logger format: ROBOTLASER1 of log_writer.c, with its remission count and turn_axis.
class CarmenText {
public:
    /// @param filter  decides which scans are integrated in the session's maps; other scans are not written
    explicit CarmenText(ScanFilter filter = ScanFilter()) : filter_(std::move(filter)) {}

    /// Returns the lines at the head of the file.
    [[nodiscard]] static std::string head(const std::string& session);

    /// Converts the next entry of the log to lines. Robots and sensors give no lines, except a comment if a sensor's
    /// range exceeds what a reader accepts by default.
    /// Errors: kConflict if the format cannot represent the entry: an imported map, a sonar scan, beams that are not
    ///         evenly spaced, or a sensor with its own aperture; kMalformed if a scan's robot or sensor is unknown.
    [[nodiscard]] Result<std::string> lines(const LogEntry& entry);

private:
    [[nodiscard]] Result<std::string> text_of(const RobotJoined& joined);
    [[nodiscard]] Result<std::string> text_of(const SensorDescribed& described);
    [[nodiscard]] Result<std::string> text_of(const ScanTaken& taken);
    [[nodiscard]] static Result<std::string> text_of(const MapPatch& patch);
    template <class Other>
    [[nodiscard]] static Result<std::string> text_of(const Other&) { // an entry without lines
        return std::string();
    }

    ScanFilter filter_;
    Revision revision_ = 0; ///< of the newest entry
    std::vector<std::string> robots_;
    std::map<std::pair<RobotIndex, std::uint32_t>, Sensor> sensors_;
    double latest_ = std::numeric_limits<double>::lowest(); ///< newest stamp written
};

} // namespace scanloom::exchange
