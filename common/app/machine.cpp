#include "common/app/machine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>
#include <thread>

#include <sys/resource.h>
#include <unistd.h>

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

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();

/// Returns the number in a file, or kNoLimit if there is none ("max").
std::uint64_t number_in(const fs::path& file) {
    std::ifstream in(file);
    std::uint64_t number = 0;
    return in >> number ? number : kNoLimit;
}

/// Returns the smallest limit of a control group and of the groups that contain it; kNoLimit if there is none.
/// @param hierarchy  folder where the control groups are mounted
/// @param group      path of this process's group; folders that do not exist have no limit (a container sees its group
///                   as the root)
/// @param file       name of the file with the limit
std::uint64_t least_limit(const fs::path& hierarchy, const fs::path& group, const char* file) {
    std::uint64_t least = number_in(hierarchy / file);
    fs::path folder = hierarchy;
    for (const auto& name : group.relative_path()) {
        folder /= name;
        least = std::min(least, number_in(folder / file));
    }
    return least;
}

std::uint64_t limit_of(int resource) {
    rlimit limit = {};
    return ::getrlimit(static_cast<__rlimit_resource>(resource), &limit) == 0 && limit.rlim_cur != RLIM_INFINITY
               ? limit.rlim_cur
               : kNoLimit;
}

} // namespace

std::optional<std::uint64_t> control_group_limit(const fs::path& root) {
    std::uint64_t least = kNoLimit;
    std::ifstream groups(root / "proc/self/cgroup");
    for (std::string line; std::getline(groups, line);) { // number:controllers:/path
        const auto first = line.find(':');
        const auto second = line.find(':', first + 1);
        if (second == std::string::npos) continue;
        const auto controllers = ',' + line.substr(first + 1, second - first - 1) + ',';
        const fs::path group = line.substr(second + 1);
        if (controllers == ",,") {
            least = std::min(least, least_limit(root / "sys/fs/cgroup", group, "memory.max"));
        } else if (controllers.find(",memory,") != std::string::npos) {
            least = std::min(least, least_limit(root / "sys/fs/cgroup/memory", group, "memory.limit_in_bytes"));
        }
    }
    return least == kNoLimit ? std::nullopt : std::optional(least);
}

MemoryLimit memory_limit() {
    const auto machine =
        static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
    return {std::min({machine, control_group_limit().value_or(kNoLimit), limit_of(RLIMIT_DATA)}), limit_of(RLIMIT_AS)};
}

} // namespace scanloom
