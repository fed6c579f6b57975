#pragma once

#include "common/app/program.hpp"
#include "load/app/options.hpp"

namespace scanloom::load {

/// Runs the whole program: connects, streams, verifies, reports, cleans up.
[[nodiscard]] ExitCode run(const LoadOptions& options);

} // namespace scanloom::load
