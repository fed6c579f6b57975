#pragma once

#include "common/error/error.hpp"
#include "common/link/requests.hpp"
#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"
#include "robot_client/client/client.hpp"

/// Checks values that no server accepts before they are sent, because sending them would end the link.
/// Errors: kInvalidField, kTooLarge; the message names the field.
namespace scanloom::robot {

/// Checks all options except those that name files. The program's flags have the same limits.
[[nodiscard]] Result<> check(const ClientOptions& options);

/// Checks a scan and the description of the sensor that took it.
[[nodiscard]] Result<> check(const Sensor& sensor, const Scan& scan);

/// Checks whether the scan has the pose and the odometry that a robot with such poses sends.
[[nodiscard]] Result<> check_poses(const Scan& scan, Poses poses);

/// Checks the values for which a server would end the link instead of refusing the request in its reply.
[[nodiscard]] Result<> check(const link::Request& request);

} // namespace scanloom::robot
