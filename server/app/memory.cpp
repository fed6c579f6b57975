#include "server/app/memory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include <malloc.h>
#include <pthread.h>

namespace scanloom::app {
namespace {

constexpr std::uint64_t kMib = std::uint64_t{1} << 20;
constexpr std::uint64_t kMapMemoryMin = 64 * kMib;
constexpr std::size_t kStackBytes = 1 << 20;

// Code and stacks after save_address_space() 260 MiB, RocksDB 128, and what requests need for a moment.
constexpr std::uint64_t kFixedAddressSpace = 448 * kMib;

bool is_limited(const MemoryLimit& limit) { return limit.address_space != std::numeric_limits<std::uint64_t>::max(); }

} // namespace

MapMemory default_map_memory(const MemoryLimit& limit) {
    const auto tiles = ServerOptions{}.tile_cache_bytes;
    const auto fixed = std::min(limit.address_space, kFixedAddressSpace + tiles);
    const auto available = std::min(limit.bytes, limit.address_space - fixed);
    const auto whole_mib = [](std::uint64_t bytes) { return std::max(kMapMemoryMin, bytes / kMib * kMib); };
    return {.maps = whole_mib(available / 2), .weaves = whole_mib(available / 4)};
}

Result<> check_address_space(const ServerOptions& options, const MemoryLimit& limit) {
    if (!is_limited(limit)) return {};
    const auto stacks = 3 * options.threads * kStackBytes; // what grows with --threads
    const auto needed =
        kFixedAddressSpace + stacks + options.tile_cache_bytes + options.map_memory_bytes + options.weave_memory_bytes;
    if (needed <= limit.address_space) return {};
    return Error{Errc::kInvalidField,
                 fmt::format("the address space of this process is limited to {} MiB, and the server needs {}: allow "
                             "that much with ulimit -v {}, or lower --map-memory, --weave-memory and --tile-cache",
                             limit.address_space / kMib, needed / kMib, needed / 1024)};
}

void save_address_space(const MemoryLimit& limit) {
    if (!is_limited(limit)) return;
    ::mallopt(M_ARENA_MAX, 1);
    pthread_attr_t attributes;
    if (::pthread_attr_init(&attributes) != 0) return;
    if (::pthread_attr_setstacksize(&attributes, kStackBytes) == 0) ::pthread_setattr_default_np(&attributes);
    ::pthread_attr_destroy(&attributes);
}

} // namespace scanloom::app
