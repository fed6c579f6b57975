#include "load/net/own_use.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <fstream>

namespace scanloom::load {
namespace {

double in_seconds(const timeval& time) {
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6;
}

} // namespace

ProcessUse own_use() {
    rusage use{};
    getrusage(RUSAGE_SELF, &use);
    std::ifstream file("/proc/self/statm"); // unit: pages; all, then resident ones
    double all = 0.0;
    double resident = 0.0;
    file >> all >> resident;
    return {in_seconds(use.ru_utime) + in_seconds(use.ru_stime), resident * static_cast<double>(sysconf(_SC_PAGESIZE))};
}

std::uint64_t raise_descriptor_limit() {
    rlimit limit{};
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return 0;
    limit.rlim_cur = limit.rlim_max;
    setrlimit(RLIMIT_NOFILE, &limit);
    getrlimit(RLIMIT_NOFILE, &limit);
    return limit.rlim_cur;
}

} // namespace scanloom::load
