#pragma once

#include "robot_client/sim/simulator.hpp"
#include "robot_client/source/source.hpp"

#include <string>
#include <string_view>

namespace scanloom::robot {

/// Returns at most 64 printable bytes that identify the scans of a simulated robot. They are the same if the world (for
/// a map, its cells), the drive, the sensors, the noise, the seed, the pose that is sent and the use of beams without a
/// return are the same.
[[nodiscard]] std::string fingerprint_of(const SimulatorOptions& options, std::string_view drive, NoReturn no_return);

} // namespace scanloom::robot
