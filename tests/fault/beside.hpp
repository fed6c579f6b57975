#pragma once

#include "tests/fault/crowd.hpp"
#include "tests/fault/paced_load.hpp"
#include "tests/fault/row.hpp"

#include <chrono>
#include <functional>
#include <vector>

namespace scanloom::fault {

/// How often, and how long each time, robots stream in peace and then beside a crowd.
struct Rounds {
    unsigned count = 1;
    std::chrono::seconds duration{3};
    bool must_keep_up = false; ///< acknowledgements may take twice as long at most
};

/// What robots notice of a crowd: the same load twice on one server, first in peace, then beside it.
struct Beside {
    std::uint64_t size = 0;            ///< of the crowd
    std::size_t bytes_of_each_max = 0; ///< of the server's memory, of each of the crowd
    /// Of it, however many there are: robots beside nobody make it grow, too, by 3 MiB in the 3 s of the short form, by
    /// up to 8 in the 20 s of the long one.
    std::size_t bytes_besides = std::size_t{12} << 20;
    Rounds rounds{};
    bool is_tried_alone = false;      ///< also while nobody else uses the machine, for comparison
    std::chrono::seconds deadline{0}; ///< whose own is no later than this one has to be hung up on
    unsigned greedy = 0;              ///< robots that send as fast as they can, all into one session of their own;
                                      ///< in peace, to another server of this machine
    /// Of connections; empty: there are none.
    std::function<std::vector<Manner>(const ServerProcess&, const PacedLoad&)> crowd = {};
};

/// Each round is on a new server. The medians count, as another program of the machine may have held up one of them.
/// Figures  those of check_paces(); the most that the server's memory grew by; "scans_of_greed", which it was sent by
///          the greedy ones beside the others, and "scans_of_greed_elsewhere", sent to the other server in peace.
[[nodiscard]] Outcome compare_with_peace(const Run& run, const Beside& beside);

/// Row "viewers": viewers that do not read. Row "flood": whoever sends slowly, without end, or nonsense, to both ports.
/// Row "greed": robots that send as fast as they are let.
[[nodiscard]] Outcome run_viewers_row(const Run& run);
[[nodiscard]] Outcome run_flood_row(const Run& run);
[[nodiscard]] Outcome run_greed_row(const Run& run);

/// What these compare. Their long form has three rounds of 20 s, in which robots must keep up.
[[nodiscard]] Beside beside_viewers(const Run& run);
[[nodiscard]] Beside beside_flood(const Run& run);
[[nodiscard]] Beside beside_greed(const Run& run);

} // namespace scanloom::fault
