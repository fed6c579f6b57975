#include "common/app/machine.hpp"

#include <fmt/format.h>

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <optional>
#include <thread>

namespace scanloom {
namespace {

std::string processor() {
    std::ifstream info("/proc/cpuinfo");
    for (std::string line; std::getline(info, line);) {
        const auto value = line.find(": ");
        const bool names_it = line.starts_with("model name") || line.starts_with("Model"); // x86, Arm boards
        if (names_it && value != std::string::npos) return line.substr(value + 2) + ", ";
    }
    return "";
}

/// Nothing where there is no such limit.
std::optional<std::uint64_t> number_in(const char* file) {
    std::ifstream in(file);
    std::uint64_t number = 0;
    return in >> number ? std::optional(number) : std::nullopt;
}

} // namespace

std::string machine_description() {
#ifdef __OPTIMIZE__
    constexpr const char* kOptimisation = "with optimisation";
#else
    constexpr const char* kOptimisation = "without optimisation";
#endif
#ifdef __clang__
    constexpr const char* kCompiler = "clang";
#else
    constexpr const char* kCompiler = "g++";
#endif
    return fmt::format("{}{} cores, {} {} {}", processor(), std::thread::hardware_concurrency(), kCompiler, __VERSION__,
                       kOptimisation);
}

std::uint64_t memory_limit() {
    auto bytes =
        static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
    for (const char* file : {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"}) {
        if (const auto limit = number_in(file)) bytes = std::min(bytes, *limit);
    }
    return bytes;
}

} // namespace scanloom
