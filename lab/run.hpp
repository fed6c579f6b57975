#pragma once

#include "lab/options.hpp"

namespace scanloom::lab {

/// Runs the chosen experiment. Progress and errors go to stderr, one line of JSON about the result to stdout.
[[nodiscard]] ExitCode run(const ExperimentOptions& options);
[[nodiscard]] ExitCode run(const LandmarkOptions& options);

} // namespace scanloom::lab
