#pragma once

#include "common/app/machine.hpp"
#include "common/error/error.hpp"
#include "server/app/options.hpp"

#include <cstddef>
#include <cstdint>
#include <string>

namespace scanloom::app {

/// Memory for maps, in bytes.
struct MapMemory {
    std::uint64_t maps = 0;        ///< of all sessions in memory
    std::uint64_t replay_jobs = 0; ///< of replay jobs

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

/// Bounds on simultaneous connections; each connection takes a file descriptor.
struct ConnectionLimits {
    std::size_t robots = 10'000;
    std::size_t greeting = 256; ///< connections of robots that have not sent a hello yet
    std::size_t http = 1024;

    friend bool operator==(const ConnectionLimits&, const ConnectionLimits&) = default;
};

/// Raises the soft limit of file descriptors to the hard limit.
/// @return the soft limit after that
std::uint64_t allow_as_many_descriptors_as_possible();

/// Returns the connection limits that are possible with this many descriptors.
///
/// 350 of them are reserved for the store and the program itself: with none left, the store could not open its next
/// file. If the rest is too small for the default limits, three quarters of it are for robots.
[[nodiscard]] ConnectionLimits limits_within(std::uint64_t descriptors) noexcept;

/// Returns a warning for the operator if the descriptors do not suffice for the default limits; otherwise an empty
/// text.
[[nodiscard]] std::string shortage(std::uint64_t descriptors);

} // namespace scanloom::app
