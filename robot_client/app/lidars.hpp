#pragma once

#include "common/app/program.hpp"
#include "common/error/error.hpp"
#include "robot_client/app/lidar_options.hpp"
#include "robot_client/lidars/lidar_probe.hpp"

#include <optional>
#include <string>
#include <vector>

namespace scanloom::robot {

/// A device, and the lidar that answered there.
struct ProbedDevice {
    std::string name;
    Result<std::optional<LidarIdentity>> lidar;
};

/// Returns what is plugged in, as lines for people, with the commands that read the lidars.
[[nodiscard]] std::string lidars_text(const std::vector<ProbedDevice>& devices);

/// Looks for lidars and prints lidars_text().
/// @return kExitDone if there is a lidar
ExitCode run(const LidarsOptions& options);

} // namespace scanloom::robot
