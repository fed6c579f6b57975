#pragma once

#include "lab/cluster_draws.hpp"
#include "lab/cluster_plan.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace scanloom::lab::cluster {

/// Robots that share a session. When it ends, they start again and create another one of the same size.
struct Group {
    std::uint32_t robots_begin = 0; ///< number of its first robot
    std::uint32_t robots_end = 0;   ///< number after its last one

    [[nodiscard]] std::uint32_t size() const noexcept { return robots_end - robots_begin; }
};

/// Divides the robots of a plan into groups. Sizes are of a log-normal distribution, rounded, at least 1 and at most
/// kSessionSizeMax. The last group has the robots that are left.
/// @return groups that follow one another, from robot 0 to the last one
[[nodiscard]] std::vector<Group> groups_of(const Plan& plan, const Draws& draws);

/// Returns 64 bits instead of the name of a session.
/// @param group    number of its group
/// @param session  how many sessions the group had before
[[nodiscard]] std::uint64_t name_of(const Draws& draws, std::size_t group, std::uint32_t session);

/// Returns how long a session lives.
/// Pre: plan.session_life_hours > 0.
[[nodiscard]] Time life_of(const Plan& plan, const Draws& draws, std::size_t group, std::uint32_t session);

} // namespace scanloom::lab::cluster
