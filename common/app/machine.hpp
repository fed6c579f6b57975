#pragma once

#include <string>

namespace scanloom {

/// Describes the machine and the build for benchmark reports: "AMD EPYC 7763, 2 cores, g++ 12.2.0 with optimisation".
/// Leaves out the processor if /proc/cpuinfo does not name it.
[[nodiscard]] std::string machine_description();

} // namespace scanloom
