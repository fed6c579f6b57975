#pragma once

#include "robot_client/app/make_source.hpp"
#include "robot_client/app/options.hpp"
#include "sim/drive/behaviour.hpp"
#include "sim/world.hpp"

#include <memory>
#include <string>

namespace scanloom::robot {

struct NamedBehaviour {
    std::unique_ptr<sim::Behaviour> behaviour;
    std::string name; ///< includes the parameters and the version: the same name drives in the same way
};

/// Makes the behaviour of a simulated robot that needs no goals from the server.
/// Errors: those of read_waypoints(); kInvalidField if there are no waypoints and the world has no tour.
[[nodiscard]] Result<NamedBehaviour> make_behaviour(const SimulateOptions& simulate, const sim::World& world);

/// Sets up a simulated robot. A robot that explores is a live source without a fingerprint, because its trajectory
/// depends on the server's replies.
/// Errors: those of load_world() and make_behaviour(); kNotFound for an unknown sensor; kInvalidField for a sensor
///         without a range.
[[nodiscard]] Result<PreparedSource> prepare_simulation(const RobotOptions& options, const SimulateOptions& simulate);

} // namespace scanloom::robot
