#pragma once

#include "robot_client/app/options.hpp"

#include <CLI/CLI.hpp>

#include <optional>
#include <string>

namespace scanloom::robot {

/// The subcommands that simulate, and their options.
CLI::App* add_simulate(CLI::App& app, SimulateOptions& options);
CLI::App* add_truth(CLI::App& app, TruthOptions& options);

/// What one option alone does not show, one sentence; nothing where all is well.
[[nodiscard]] std::optional<std::string> mistake_in(const SimulateOptions& options);
[[nodiscard]] std::optional<std::string> mistake_in(const TruthOptions& options);

} // namespace scanloom::robot
