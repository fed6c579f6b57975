#pragma once

#include "common/error/error.hpp"
#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"
#include "robot_client/client/client.hpp"
#include "robot_client/uplink/open_requests.hpp"

/// What no server takes is refused here, before it ends the link: each value is checked as it is there.
/// Errors  kInvalidField, kTooLarge: the message names the field.
namespace scanloom::robot {

/// Without those of files. The program's flags have the same limits.
[[nodiscard]] Result<> check(const ClientOptions& options);

[[nodiscard]] Result<> check(const Sensor& sensor, const Scan& scan);

/// Of a request's values those that a server would not refuse in a reply, but end the link for.
[[nodiscard]] Result<> check(const Request& request);

} // namespace scanloom::robot
