#pragma once

#include "robot_client/source/ld06_turns.hpp"
#include "robot_client/source/source.hpp"

#include <cstdint>
#include <memory>
#include <optional>

namespace scanloom::robot {

/// Defaults are those of the sensor's data sheet unless a comment states another source.
struct Ld06ScanOptions {
    double range_min = 0.02; ///< metres; shorter readings are invalid
    double range_max = 12.0; ///< metres; readings of at least this length are no-returns
    NoReturn no_return = NoReturn::kFree;
    /// Readings of less confidence are invalid. In a real recording of a room with a stationary sensor, one in three
    /// readings below 100 lies more than 0.15 m from the median of its half degree, but fewer than 2 in 100 of the
    /// others do; fewer than 1 in 100 readings are below 100.
    std::uint8_t confidence_min = 100;
    std::optional<int> median_window; ///< beams, see median_filtered()
    Pose2 mount;                      ///< T_robot_sensor; the sensor's x axis is its 0 degrees
};

/// Returns the sensor's description for the server.
[[nodiscard]] std::shared_ptr<const Sensor> ld06_sensor(const Ld06ScanOptions& options);

/// Converts a turn into a scan without a pose.
///
/// Beams are in counter-clockwise order. The sensor turns clockwise, so the turn's last point is the first beam. Angles
/// are whole multiples of 0.01/11 degree, from 0 (excluded) to a full turn. The scan keeps common/scan/limits.hpp. A
/// distance of 0 becomes an invalid beam: the sensor saw nothing or could not measure.
[[nodiscard]] Scan ld06_scan(const Ld06Turn& turn, const Ld06ScanOptions& options);

} // namespace scanloom::robot
