#pragma once

#include "robot_client/app/options.hpp"

#include <CLI/CLI.hpp>

#include <optional>
#include <string>

namespace scanloom::robot {

/// Add the subcommands for simulation and truth, which set `options`.
CLI::App* add_simulate(CLI::App& app, sim::SimulatedRobotOptions& options);
CLI::App* add_ground_truth(CLI::App& app, GroundTruthOptions& options);

/// Returns one sentence about an error that a single option does not show, or nullopt if there is none.
/// @param options  options of the subcommand
/// @param poses    what the robot's poses are
[[nodiscard]] std::optional<std::string> mistake_in(const sim::SimulatedRobotOptions& options, Poses poses);
/// Returns one sentence about an error that a single option does not show, or nullopt if there is none.
[[nodiscard]] std::optional<std::string> mistake_in(const GroundTruthOptions& options);

} // namespace scanloom::robot
