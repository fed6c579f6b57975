#pragma once

#include "lab/cluster_plan.hpp"
#include "lab/cluster_result.hpp"
#include "lab/cluster_size.hpp"

#include <cstddef>
#include <optional>
#include <string>

namespace scanloom::lab::cluster {

/// The result of the command cluster.
struct Report {
    Size size;
    Outcome outcome;
    std::optional<std::size_t> nodes_needed; ///< see nodes_needed()
};

/// Runs the simulation of a plan.
/// Pre: check(plan).
[[nodiscard]] Report report_of(const Plan& plan);

/// Returns tables for people, as Markdown; the last line has no line ending.
[[nodiscard]] std::string tables_of(const Plan& plan, const Report& report);

/// Returns one line of JSON, without line ending.
[[nodiscard]] std::string json_of(const Plan& plan, const Report& report);

} // namespace scanloom::lab::cluster
