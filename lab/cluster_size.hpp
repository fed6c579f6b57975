#pragma once

#include "lab/cluster_plan.hpp"

#include <cstddef>
#include <optional>

namespace scanloom::lab::cluster {

/// What a plan needs, by arithmetic: as if each node had an equal share.
struct Size {
    double scans_per_s = 0.0;
    double node_cores = 0.0; ///< of all nodes together
    double primary_cores = 0.0;
    double standby_cores = 0.0;
    double log_mbytes_per_s = 0.0;   ///< megabytes (10^6) of log per second
    double log_tbytes_per_day = 0.0; ///< terabytes (10^12) of log per day
    std::size_t nodes = 0;    ///< smallest number that uses at most kFullShare of its cores while one node is down
    std::size_t clusters = 0; ///< smallest number into which the robots must be divided, because each has one database,
                              ///< which uses at most kFullShare of its cores and its bytes per second
};

[[nodiscard]] Size size_of(const Plan& plan);

/// Returns the smallest number of nodes with which the fullest one uses at most kFullShare of its cores, after the
/// first node was killed. Simulates one minute for each number that it tries.
/// @return nullopt if four times the nodes of size_of() are not enough
/// Pre: check(plan).
[[nodiscard]] std::optional<std::size_t> nodes_needed(const Plan& plan);

} // namespace scanloom::lab::cluster
