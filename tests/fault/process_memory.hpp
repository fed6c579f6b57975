#pragma once

#include <cstdint>
#include <fstream>
#include <string>

#include <sys/types.h>

namespace scanloom::fault {

/// Returns a process's resident memory in bytes; 0: there is no such process.
[[nodiscard]] inline std::uint64_t resident_bytes(pid_t process) {
    std::ifstream status("/proc/" + std::to_string(process) + "/status");
    for (std::string line; std::getline(status, line);) {
        if (line.starts_with("VmRSS:")) return std::stoull(line.substr(6)) << 10;
    }
    return 0;
}

} // namespace scanloom::fault
