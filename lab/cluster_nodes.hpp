#pragma once

#include "lab/cluster_draws.hpp"
#include "lab/cluster_plan.hpp"

#include <cstddef>
#include <vector>

namespace scanloom::lab::cluster {

/// How a node ends, as the robots and the other nodes notice it.
enum class End {
    kStopped, ///< it gives its sessions up one after another and sends their robots on to other nodes
    kKilled,  ///< the system closes its connections and refuses new ones; the sessions are free after some seconds
    kSilent,  ///< as kKilled, but no connection is closed or refused: packets are lost
};

/// A time in which a node does not run.
struct Outage {
    std::size_t node = 0;
    End end = End::kStopped;
    Time down{0}; ///< when it ends
    Time up{0};   ///< when it is ready again, with the same name
};

/// Returns the failures of a plan and the restarts of its upgrade.
///
/// Failures of a node have exponentially distributed times between a repair and the next failure. The upgrade stops
/// each node as soon as the one before is ready. It skips a node that has failed. Failures during a restart are left
/// out.
/// @return by time, then by node; outages of one node do not touch
[[nodiscard]] std::vector<Outage> outages_of(const Plan& plan, const Draws& draws);

/// Returns when the last node of the upgrade is ready.
/// Pre: plan.upgrade_at_hours > 0.
[[nodiscard]] Time end_of_upgrade(const Plan& plan);

} // namespace scanloom::lab::cluster
