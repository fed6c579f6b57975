#pragma once

#include "lab/cluster_draws.hpp"
#include "lab/cluster_nodes.hpp"
#include "lab/cluster_plan.hpp"
#include "lab/cluster_result.hpp"

#include <vector>

namespace scanloom::lab::cluster {

/// Periods of the programs, which decide how long robots wait.
inline constexpr Time kDeadAfter{5'000};       ///< a node that has not renewed its row for so long counts as dead
inline constexpr Time kRenewEvery{1'000};      ///< how often it renews the row
inline constexpr Time kConnectMax{3'000};      ///< of a robot that knows several nodes
inline constexpr Time kWelcomeTimeout{10'000}; ///< of a robot, from its hello
inline constexpr Time kUnconfirmedMax{5'000};  ///< likewise: then its connection to a silent machine has failed
inline constexpr Time kAnswer{1};              ///< from a connection's begin to the server's answer; assumed
inline constexpr Time kStartSpread{1'000};     ///< the robots of a session start within this time; assumed
inline constexpr Time kMeasureFrom{10'000};    ///< figures of loads begin when all robots have started

/// Simulates a plan.
///
/// A session is owned by the node that was asked for it first. Other nodes send robots there. If the owner has been
/// dead for kDeadAfter, has given the session up or was started again, the next node that is asked takes the session.
/// A node that is stopped sends the robots of each session on to the running node with the fewest sessions.
/// Robots choose servers and wait as scanloom-robot does: those of a session have the same order of the nodes, and
/// orders of sessions are independent. Sessions that a node takes are loaded one after another, by as many threads as
/// the server has for it.
///
/// @param outages  when nodes do not run, by time; those of one node do not touch
/// Pre: check(plan).
[[nodiscard]] Outcome simulate(const Plan& plan, const std::vector<Outage>& outages);

/// Simulates a plan with its failures and its upgrade.
[[nodiscard]] Outcome simulate(const Plan& plan);

} // namespace scanloom::lab::cluster
