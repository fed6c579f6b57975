#include "lab/cluster_size.hpp"

#include "lab/cluster_simulation.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace scanloom::lab::cluster {
namespace {

constexpr std::size_t kTriedMax = 4; // times the number by arithmetic
constexpr double kSecondsPerDay = 86'400.0;

std::size_t count_for(double needed, double of_each) {
    return std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(needed / (kFullShare * of_each))));
}

/// Returns whether the fullest of so many nodes has room while the first one is down.
bool have_room(Plan plan, std::size_t nodes) {
    plan.nodes = nodes;
    plan.duration_hours = 1.0 / 60.0;
    plan.session_life_hours = 0.0;
    plan.upgrade_at_hours = 0.0;
    const Outage killed{.node = 0, .end = End::kKilled, .down = of_seconds(20), .up = of_hours(1)};
    const Outcome outcome = simulate(plan, nodes > 1 ? std::vector{killed} : std::vector<Outage>());
    const double scans_per_s = static_cast<double>(outcome.node_robots_max) * plan.rate_hz;
    return scans_per_s * plan.node_us <= kFullShare * plan.node_cores * 1e6;
}

} // namespace

Size size_of(const Plan& plan) {
    Size size;
    size.scans_per_s = static_cast<double>(plan.robots) * plan.rate_hz;
    size.node_cores = size.scans_per_s * plan.node_us / 1e6;
    size.primary_cores = size.scans_per_s * plan.primary_us / 1e6;
    size.standby_cores = size.scans_per_s * plan.standby_us / 1e6;
    size.log_mbytes_per_s = size.scans_per_s * plan.log_bytes / 1e6;
    size.log_tbytes_per_day = size.log_mbytes_per_s * kSecondsPerDay / 1e6;
    size.nodes = count_for(size.node_cores, plan.node_cores) + 1;
    size.clusters = std::max(count_for(size.primary_cores, plan.database_cores),
                             count_for(size.log_mbytes_per_s, plan.database_mbytes));
    return size;
}

std::optional<std::size_t> nodes_needed(const Plan& plan) {
    std::size_t low = size_of(plan).nodes;
    std::size_t high = kTriedMax * low;
    if (!have_room(plan, high)) return std::nullopt;
    while (low < high) { // more nodes are taken to be better
        const std::size_t middle = (low + high) / 2;
        if (have_room(plan, middle))
            high = middle;
        else
            low = middle + 1;
    }
    return high;
}

} // namespace scanloom::lab::cluster
