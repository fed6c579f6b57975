#pragma once

#include "robot_client/sim/simulator.hpp"
#include "robot_client/source/source.hpp"

#include <string>
#include <string_view>

namespace scanloom::robot {

/// Identifies the scans of a simulated robot: the same where the world (of a map, its cells), the drive, the
/// sensors, the noise, the seed, the pose that is sent and what becomes of beams without return are the same. At most
/// 64 printable bytes.
[[nodiscard]] std::string fingerprint_of(const SimulatorOptions& options, std::string_view drive, NoReturn no_return);

} // namespace scanloom::robot
