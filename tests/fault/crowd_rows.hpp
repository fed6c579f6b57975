#pragma once

#include "tests/fault/crowd.hpp"
#include "tests/fault/paced_load.hpp"
#include "tests/fault/row.hpp"

#include <chrono>
#include <functional>
#include <vector>

namespace scanloom::fault {

/// How often, and how long each time, robots stream without a crowd and then with one.
struct Rounds {
    unsigned count = 1;
    std::chrono::seconds duration{3};
    bool must_keep_up = false; ///< acknowledgements may take at most twice as long
};

/// The effect of a crowd on robots: the same load twice on one server, first without the crowd, then with it.
struct CrowdTrial {
    std::uint64_t size = 0;            ///< number of connections in the crowd
    std::size_t bytes_of_each_max = 0; ///< of the server's memory, for each connection
    /// Of the server's memory, independent of `size`. Without a crowd, robots also make it grow: by 3 MiB in the 3 s of
    /// the short form, by up to 8 MiB in the 20 s of the long form.
    std::size_t bytes_base = std::size_t{12} << 20;
    Rounds rounds{};
    bool is_tried_alone = false;      ///< also while the machine is otherwise idle, for comparison
    std::chrono::seconds deadline{0}; ///< the server must close all connections with this deadline or an earlier one
    unsigned greedy = 0; ///< robots that send as fast as they can, all into one session of their own; in the run
                         ///< without the crowd, to another server of this machine
    /// Returns the connections of the crowd. Empty: there is no crowd.
    std::function<std::vector<Behaviour>(const ServerProcess&, const PacedLoad&)> crowd = {};
};

/// Runs each round on a new server. Compares the medians, as another program may have delayed one of the rounds.
/// Figures  those of check_latency(); the largest growth of the server's memory; "scans_of_greed", the number of scans
/// that the greedy robots sent to the server under test, and "scans_of_greed_elsewhere", the number sent to the other
/// server in the run without the crowd.
[[nodiscard]] Outcome compare_with_baseline(const Run& run, const CrowdTrial& trial);

/// Row "viewers": viewers that do not read. Row "flood": clients that send slowly, without end, or invalid bytes, to
/// both ports. Row "greed": robots that send as fast as the server permits.
[[nodiscard]] Outcome run_viewers_row(const Run& run);
[[nodiscard]] Outcome run_flood_row(const Run& run);
[[nodiscard]] Outcome run_greed_row(const Run& run);

/// The settings of these rows. Their long form has three rounds of 20 s, in which robots must keep up.
[[nodiscard]] CrowdTrial viewers_trial(const Run& run);
[[nodiscard]] CrowdTrial flood_trial(const Run& run);
[[nodiscard]] CrowdTrial greed_trial(const Run& run);

} // namespace scanloom::fault
