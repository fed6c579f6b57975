#include "server/app/descriptors.hpp"

#include <fmt/format.h>

#include <sys/resource.h>

#include <algorithm>

namespace scanloom::app {
namespace {

constexpr std::uint64_t kKept = 350;      // RocksDB has up to 256 files open
constexpr std::uint64_t kTurnedAway = 64; // connections that are open only to receive the reason of a refusal
constexpr std::uint64_t kAtLeast = 8;

} // namespace

std::uint64_t allow_as_many_descriptors_as_possible() {
    rlimit limit{};
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return 1024;
    const auto before = limit.rlim_cur;
    limit.rlim_cur = limit.rlim_max;
    return setrlimit(RLIMIT_NOFILE, &limit) == 0 ? limit.rlim_cur : before;
}

ConnectionLimits limits_within(std::uint64_t descriptors) noexcept {
    const ConnectionLimits wished;
    const auto kept = kKept + kTurnedAway;
    const auto free = descriptors > kept ? descriptors - kept : 0;
    // Connections without a hello count twice: all of them may send it at once while the same number of new ones
    // arrive.
    if (free >= wished.robots + 2 * wished.greeting + wished.http) return wished;
    ConnectionLimits limits;
    limits.http = std::clamp<std::uint64_t>(free / 4, kAtLeast, wished.http);
    limits.greeting = std::clamp<std::uint64_t>(free / 16, kAtLeast, wished.greeting);
    const auto others = limits.http + 2 * limits.greeting;
    limits.robots = std::max(kAtLeast, free > others ? free - others : 0);
    return limits;
}

std::string shortage(std::uint64_t descriptors) {
    const ConnectionLimits wished;
    const auto limits = limits_within(descriptors);
    if (limits == wished) return {};
    return fmt::format("{} file descriptors suffice for {} robots and {} HTTP connections at once; allow more "
                       "(ulimit -n, LimitNOFILE=) for {} and {}",
                       descriptors, limits.robots, limits.http, wished.robots, wished.http);
}

} // namespace scanloom::app
