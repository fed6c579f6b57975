#pragma once

#include <cstdint>
#include <string>

namespace scanloom {

/// What figures of speed were measured on: "AMD EPYC 7763, 2 cores, g++ 12.2.0 with optimisation". For reports.
/// Source  /proc/cpuinfo; a part that it does not tell is left out.
[[nodiscard]] std::string machine_description();

/// Bytes of memory that this process may use: the machine's, or those of its control group where these are fewer.
/// Source  sysconf(3); /sys/fs/cgroup/memory.max (cgroup v2), .../memory/memory.limit_in_bytes (v1).
[[nodiscard]] std::uint64_t memory_limit();

} // namespace scanloom
