#pragma once

#include "common/error/error.hpp"
#include "load/app/options.hpp"
#include "load/core/workload.hpp"

namespace scanloom::load {

/// Drives a simulated robot along the walls of the world and prepares its scans: options.course of them, or as many as
/// each robot will send if these are fewer.
/// Errors: those of load_world() and find_laser(); kTooLarge: a frame cannot hold --batch scans of this laser.
[[nodiscard]] Result<Workload> record_workload(const LoadOptions& options);

} // namespace scanloom::load
