#pragma once

#include <string>

namespace scanloom {

/// What figures of speed were measured on: "AMD EPYC 7763, 2 cores, g++ 12.2.0 with optimisation". For reports.
/// Source  /proc/cpuinfo; a part that it does not tell is left out.
[[nodiscard]] std::string machine_description();

} // namespace scanloom
