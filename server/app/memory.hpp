#pragma once

#include "common/app/memory_limit.hpp"
#include "common/error/error.hpp"
#include "server/app/options.hpp"

#include <cstdint>

namespace scanloom::app {

/// Memory for maps, in bytes.
struct MapMemory {
    std::uint64_t maps = 0;   ///< of all sessions in memory
    std::uint64_t weaves = 0; ///< of replay jobs

    friend bool operator==(const MapMemory&, const MapMemory&) = default;
};

/// Returns half of the available memory for maps and a quarter for replay jobs, but at least 64 MiB for each.
///
/// Where the address space is limited, code, thread stacks, RocksDB and the tile cache are subtracted first.
[[nodiscard]] MapMemory default_map_memory(const MemoryLimit& limit);

/// Checks that maps, replay jobs and cached tiles of `options` fit into the address space.
/// Errors: kInvalidField if `ulimit -v` is too low; the message contains the limit and the size that the server needs.
[[nodiscard]] Result<> check_address_space(const ServerOptions& options, const MemoryLimit& limit);

/// If the address space is limited, makes glibc reserve less of it: with one heap for all threads and stacks of 1 MiB
/// an idle server takes 260 MiB instead of 950 (VmPeak in /proc/PID/status).
/// Pre: no thread has been started.
void save_address_space(const MemoryLimit& limit);

} // namespace scanloom::app
