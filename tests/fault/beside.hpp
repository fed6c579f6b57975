#pragma once

#include "tests/fault/crowd.hpp"
#include "tests/fault/paced_load.hpp"
#include "tests/fault/row.hpp"

#include <chrono>
#include <functional>
#include <vector>

namespace scanloom::fault {

/// What robots notice of a crowd: the same load twice on one server, first in peace, then beside it.
struct Beside {
    std::uint64_t size = 0;            ///< of the crowd
    std::size_t bytes_of_each_max = 0; ///< of the server's memory, of each of the crowd
    /// Of it, however many there are: robots beside nobody make it grow, too, by 3 MiB in the 3 s of the short form, by
    /// up to 8 in the 20 s of the long one.
    std::size_t bytes_besides = std::size_t{12} << 20;
    bool must_keep_up = false;        ///< acknowledgements may take twice as long at most
    std::chrono::seconds deadline{0}; ///< whose own is no later than this one has to be hung up on
    unsigned greedy = 0;              ///< robots that send as fast as they can, all into one session of their own;
                                      ///< in peace, to another server of this machine
    /// Of connections; empty: there are none.
    std::function<std::vector<Manner>(const ServerProcess&, const PacedLoad&)> crowd = {};
};

/// Where they must keep up, this is done three times, on a new server each, and the median counts: another program of
/// the machine may have held up one of them.
/// Figures  p99 of acknowledgements in peace and beside the crowd, in microseconds; the most that the server's memory
///          grew by.
[[nodiscard]] Outcome compare_with_peace(const Run& run, const Beside& beside);

/// Row "viewers": viewers that do not read. Row "flood": whoever sends slowly, without end, or nonsense, to both ports.
/// Row "greed": robots that send as fast as they are let.
[[nodiscard]] Outcome run_viewers_row(const Run& run);
[[nodiscard]] Outcome run_flood_row(const Run& run);
[[nodiscard]] Outcome run_greed_row(const Run& run);

constexpr std::uint64_t kViewersLong = 1'000;
constexpr std::uint64_t kFloodLong = 600;
constexpr std::uint64_t kGreedLong = 8;

} // namespace scanloom::fault
