#pragma once

#include "robot_client/app/options.hpp"
#include "robot_client/drive/behaviour.hpp"
#include "robot_client/sim/world.hpp"

#include <memory>
#include <string>

namespace scanloom::robot {

struct NamedBehaviour {
    std::unique_ptr<Behaviour> behaviour;
    std::string name; ///< includes the parameters: the same name drives in the same way
};

/// Makes the behaviour of a simulated robot that needs no goals from the server.
/// Errors: those of read_waypoints(); kInvalidField if there are no waypoints and the world has no tour.
[[nodiscard]] Result<NamedBehaviour> make_behaviour(const SimulateOptions& simulate, const World& world);

} // namespace scanloom::robot
