#include "server/metrics/process.hpp"

#include "server/metrics/metrics.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>

namespace scanloom::metrics {
namespace {

struct ProcessStat {
    double cpu_ticks = 0.0;
    double start_ticks = 0.0; ///< since boot
    double virtual_bytes = 0.0;
    double resident_pages = 0.0;
};

/// Field 2, the program's name, may contain any character; it ends at the last parenthesis.
std::optional<ProcessStat> read_stat(const std::filesystem::path& proc) {
    std::ifstream file(proc / "self/stat");
    std::string line;
    if (!std::getline(file, line)) return std::nullopt;
    const auto name_end = line.rfind(')');
    if (name_end == std::string::npos) return std::nullopt;
    std::istringstream rest(line.substr(name_end + 1));
    std::string state;
    rest >> state; // field 3
    ProcessStat stat;
    for (int field = 4; field <= 24; ++field) {
        double value = 0.0;
        if (!(rest >> value)) return std::nullopt;
        if (field == 14 || field == 15) stat.cpu_ticks += value; // user, system
        if (field == 22) stat.start_ticks = value;
        if (field == 23) stat.virtual_bytes = value;
        if (field == 24) stat.resident_pages = value;
    }
    return stat;
}

/// Returns the boot time of the machine, in seconds since the epoch.
std::optional<double> boot_time(const std::filesystem::path& proc) {
    std::ifstream file(proc / "stat");
    std::string line;
    while (std::getline(file, line)) {
        std::istringstream words(line);
        std::string name;
        double seconds = 0.0;
        if (words >> name >> seconds && name == "btime") return seconds;
    }
    return std::nullopt;
}

std::optional<double> open_fds(const std::filesystem::path& proc) {
    std::error_code failed;
    double count = 0.0;
    for (std::filesystem::directory_iterator entry(proc / "self/fd", failed), end; !failed && entry != end;
         entry.increment(failed)) {
        ++count;
    }
    if (failed) return std::nullopt;
    return count - 1.0; // the directory itself
}

} // namespace

std::vector<prometheus::MetricFamily> process_families(const std::filesystem::path& proc) {
    std::vector<prometheus::MetricFamily> families;
    const auto ticks_per_second = static_cast<double>(sysconf(_SC_CLK_TCK));
    if (const auto stat = read_stat(proc)) {
        families.push_back(counter_now("process_cpu_seconds_total", "CPU time used, user and system.",
                                       stat->cpu_ticks / ticks_per_second));
        families.push_back(gauge_now("process_resident_memory_bytes", "Memory that is in RAM.",
                                     stat->resident_pages * static_cast<double>(sysconf(_SC_PAGESIZE))));
        families.push_back(gauge_now("process_virtual_memory_bytes", "Memory that is addressed.", stat->virtual_bytes));
        if (const auto boot = boot_time(proc)) {
            families.push_back(gauge_now("process_start_time_seconds", "Start of the process since the epoch.",
                                         *boot + stat->start_ticks / ticks_per_second));
        }
    }
    if (const auto count = open_fds(proc)) {
        families.push_back(gauge_now("process_open_fds", "File descriptors that are open.", *count));
    }
    if (rlimit limit{}; getrlimit(RLIMIT_NOFILE, &limit) == 0) {
        families.push_back(
            gauge_now("process_max_fds", "File descriptors that may be open.", static_cast<double>(limit.rlim_cur)));
    }
    return families;
}

} // namespace scanloom::metrics
