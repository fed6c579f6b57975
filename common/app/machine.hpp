#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace scanloom {

/// Describes the machine and the build for benchmark reports: "AMD EPYC 7763, 2 cores, g++ 12.2.0 with optimisation".
/// Leaves out the processor if /proc/cpuinfo does not name it.
[[nodiscard]] std::string machine_description();

/// The memory that this process may use, in bytes.
struct MemoryLimit {
    std::uint64_t bytes = 0; ///< the machine's memory, or the limit of its control group or of `ulimit -d`, if less
    std::uint64_t address_space = 0; ///< the limit of `ulimit -v`; the largest number if there is none
};

/// Returns the memory limits of this process.
/// Source: sysconf(3), getrlimit(2), control_group_limit().
[[nodiscard]] MemoryLimit memory_limit();

/// Returns the smallest memory limit of this process's control group and of the groups that contain it.
/// @param root  folder that contains proc/ and sys/; tests use another
/// @return bytes; nullopt if there is no limit
/// Source: cgroups(7): memory.max of version 2, memory.limit_in_bytes of version 1.
[[nodiscard]] std::optional<std::uint64_t> control_group_limit(const std::filesystem::path& root = "/");

} // namespace scanloom
