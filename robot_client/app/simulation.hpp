#pragma once

#include "robot_client/app/make_source.hpp"

namespace scanloom::robot {

/// Sets up a simulated robot. A robot that explores is a live source without a fingerprint, because its trajectory
/// depends on the server's replies.
/// Errors: those of load_world() and make_behaviour(); kNotFound for an unknown sensor; kInvalidField for a sensor
///         without a range.
[[nodiscard]] Result<PreparedSource> prepare_simulation(const RobotOptions& options, const SimulateOptions& simulate);

} // namespace scanloom::robot
