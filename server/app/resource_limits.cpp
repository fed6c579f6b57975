#include "server/app/resource_limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include <malloc.h>
#include <pthread.h>
#include <sys/resource.h>

namespace scanloom::app {
namespace {

constexpr std::uint64_t kMib = std::uint64_t{1} << 20;
constexpr std::uint64_t kMapMemoryMin = 64 * kMib;
constexpr std::size_t kStackBytes = 1 << 20;

// Code and stacks after save_address_space() take 260 MiB, RocksDB 128; the rest is for requests while they run.
constexpr std::uint64_t kFixedAddressSpace = 448 * kMib;

bool is_limited(const MemoryLimit& limit) { return limit.address_space != std::numeric_limits<std::uint64_t>::max(); }

} // namespace

MapMemory default_map_memory(const MemoryLimit& limit) {
    const auto tiles = ServerOptions{}.tile_cache_bytes;
    const auto fixed = std::min(limit.address_space, kFixedAddressSpace + tiles);
    const auto available = std::min(limit.bytes, limit.address_space - fixed);
    const auto whole_mib = [](std::uint64_t bytes) { return std::max(kMapMemoryMin, bytes / kMib * kMib); };
    return {.maps = whole_mib(available / 2), .replay_jobs = whole_mib(available / 4)};
}

/// Returns the address space that the server needs, in bytes, with at least `maps` for maps and replay jobs.
static std::uint64_t needed_with(const ServerOptions& options, MapMemory maps) {
    const auto stacks = 3 * options.threads * kStackBytes; // grows with --threads
    return kFixedAddressSpace + stacks + options.tile_cache_bytes + std::max(options.map_memory_bytes, maps.maps) +
           std::max(options.replay_memory_bytes, maps.replay_jobs);
}

/// Returns a limit of the address space that suffices. It is found iteratively because a greater limit also increases
/// the default memory for maps.
static std::uint64_t enough_for(const ServerOptions& options, const MemoryLimit& limit) {
    auto enough = needed_with(options, {});
    for (;;) {
        const auto needed = needed_with(options, default_map_memory({limit.bytes, enough}));
        if (needed <= enough) return enough;
        enough = needed;
    }
}

Result<> check_address_space(const ServerOptions& options, const MemoryLimit& limit) {
    if (!is_limited(limit) || needed_with(options, {}) <= limit.address_space) return {};
    const auto enough = enough_for(options, limit);
    return Error{Errc::kInvalidField,
                 fmt::format("the address space of this process is limited to {} MiB, and the server needs {}; raise "
                             "the limit with ulimit -v {}, or lower --map-memory, --weave-memory and --tile-cache",
                             limit.address_space / kMib, enough / kMib, enough / 1024)};
}

void save_address_space(const MemoryLimit& limit) {
    if (!is_limited(limit)) return;
    ::mallopt(M_ARENA_MAX, 1);
    pthread_attr_t attributes;
    if (::pthread_attr_init(&attributes) != 0) return;
    if (::pthread_attr_setstacksize(&attributes, kStackBytes) == 0) ::pthread_setattr_default_np(&attributes);
    ::pthread_attr_destroy(&attributes);
}

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
