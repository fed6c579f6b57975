#pragma once

#include "robot_client/source/ld06_turns.hpp"
#include "robot_client/source/source.hpp"

#include <cstdint>
#include <memory>
#include <optional>

namespace scanloom::robot {

/// The defaults are those of the sensor's data sheet where no comment says more.
struct Ld06ScanOptions {
    double range_min = 0.02; ///< metres; shorter readings are invalid
    double range_max = 12.0; ///< metres; readings of this length or more saw nothing within it
    NoReturn no_return = NoReturn::kFree;
    /// Readings of less confidence are invalid. In a real recording of a room, the sensor standing still, one in three
    /// readings below 100 lies more than 0.15 m from the median of its half degree, and of the others fewer than 2 in
    /// 100; and fewer than 1 in 100 readings are below.
    std::uint8_t confidence_min = 100;
    std::optional<int> median_window; ///< beams, see median_filtered()
    Pose2 mount;                      ///< T_robot_sensor; the sensor's x axis is its 0 degrees
};

/// What a turn looks like to the server.
[[nodiscard]] std::shared_ptr<const Sensor> ld06_sensor(const Ld06ScanOptions& options);

/// The turn as a scan without a pose.
/// Shapes  beams counter-clockwise: the sensor turns clockwise, so that the turn's last point is the first beam.
/// Units   angles are whole multiples of 0.01/11 degree, from 0 (not included) to a full turn.
/// Post    keeps common/scan/limits.hpp. A distance of 0 is an invalid beam: the sensor saw nothing or could not tell.
[[nodiscard]] Scan ld06_scan(const Ld06Turn& turn, const Ld06ScanOptions& options);

} // namespace scanloom::robot
