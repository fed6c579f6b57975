#pragma once

#include "robot_client/app/options.hpp"
#include "robot_client/drive/behaviour.hpp"
#include "robot_client/sim/world.hpp"

#include <memory>
#include <string>

namespace scanloom::robot {

struct NamedBehaviour {
    std::unique_ptr<Behaviour> behaviour;
    std::string name; ///< with what it was made of: the same name drives the same way
};

/// How a simulated robot drives that needs nobody to tell it the way.
/// Errors  those of read_waypoints(); kInvalidField: no waypoints, and none known for the world.
[[nodiscard]] Result<NamedBehaviour> make_behaviour(const SimulateOptions& simulate, const World& world);

} // namespace scanloom::robot
