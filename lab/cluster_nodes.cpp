#include "lab/cluster_nodes.hpp"

#include <algorithm>
#include <tuple>

namespace scanloom::lab::cluster {
namespace {

bool touch(const Outage& one, const Outage& other) { return one.down <= other.up && other.down <= one.up; }

/// Returns the failures of a node, by time.
std::vector<Outage> failures_of(const Plan& plan, const Draws& draws, std::size_t node) {
    std::vector<Outage> failures;
    if (plan.failure_hours <= 0.0) return failures;
    const Time end = of_hours(plan.duration_hours);
    Time up{0};
    for (std::uint64_t count = 0;; ++count) {
        const double hours = draws.exponential(plan.failure_hours, Use::kFailure, node, count);
        if (in_seconds(up) / 3600.0 + hours >= plan.duration_hours) return failures; // of_hours() has no such range
        const Time down = up + std::max(Time(1), of_hours(hours));
        if (down >= end) return failures;
        const bool is_silent = draws.unit(Use::kSilence, node, count) < plan.silent_share;
        up = down + std::max(Time(1), of_minutes(plan.repair_minutes));
        failures.push_back({node, is_silent ? End::kSilent : End::kKilled, down, up});
    }
}

Outage restart_of(const Plan& plan, std::size_t node) {
    const Time each = of_seconds(plan.restart_s);
    const Time down = of_hours(plan.upgrade_at_hours) + static_cast<std::int64_t>(node) * (each + Time(1));
    return {node, End::kStopped, down, down + each};
}

/// Adds the restart of a node to its failures, unless it has failed then.
void add_restart(std::vector<Outage>& failures, const Outage& restart) {
    const auto is_down = [&](const Outage& failure) { return failure.down <= restart.down && touch(failure, restart); };
    if (std::ranges::any_of(failures, is_down)) return;
    std::erase_if(failures, [&](const Outage& failure) { return touch(failure, restart); });
    failures.push_back(restart);
}

} // namespace

std::vector<Outage> outages_of(const Plan& plan, const Draws& draws) {
    std::vector<Outage> all;
    for (std::size_t node = 0; node < plan.nodes; ++node) {
        auto outages = failures_of(plan, draws, node);
        if (plan.upgrade_at_hours > 0.0) add_restart(outages, restart_of(plan, node));
        all.insert(all.end(), outages.begin(), outages.end());
    }
    std::ranges::sort(all, {}, [](const Outage& outage) { return std::tuple(outage.down, outage.node); });
    return all;
}

Time end_of_upgrade(const Plan& plan) { return restart_of(plan, plan.nodes - 1).up; }

} // namespace scanloom::lab::cluster
