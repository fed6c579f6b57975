#pragma once

#include "robot_client/app/make_source.hpp"

namespace scanloom::robot {

/// Sets up a simulated robot. One that explores is a live source without a fingerprint: where it drives depends on what
/// it is told.
/// Errors  those of load_world() and make_behaviour(); an unknown sensor, or one without a range.
[[nodiscard]] Result<PreparedSource> prepare_simulation(const RobotOptions& options, const SimulateOptions& simulate);

} // namespace scanloom::robot
