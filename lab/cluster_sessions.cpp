#include "lab/cluster_sessions.hpp"

#include <algorithm>
#include <cmath>

namespace scanloom::lab::cluster {
namespace {

constexpr Time kLifeMin{10'000}; // so that every robot has started

/// The mean of exp(a + s * normal) is exp(a + s * s / 2).
double drawn_size(const Plan& plan, const Draws& draws, std::size_t group) {
    const double spread = plan.session_spread;
    const double logarithm =
        std::log(plan.session_size) - spread * spread / 2.0 + spread * draws.normal(Use::kSessionSize, group);
    return std::clamp(std::round(std::exp(logarithm)), 1.0, kSessionSizeMax);
}

} // namespace

std::vector<Group> groups_of(const Plan& plan, const Draws& draws) {
    std::vector<Group> groups;
    const auto robots = static_cast<std::uint32_t>(plan.robots);
    for (std::uint32_t begin = 0; begin < robots;) {
        const auto size = static_cast<std::uint32_t>(drawn_size(plan, draws, groups.size()));
        const std::uint32_t end = begin + std::min(size, robots - begin);
        groups.push_back({begin, end});
        begin = end;
    }
    return groups;
}

std::uint64_t name_of(const Draws& draws, std::size_t group, std::uint32_t session) {
    return draws.bits(Use::kSessionName, group, session);
}

Time life_of(const Plan& plan, const Draws& draws, std::size_t group, std::uint32_t session) {
    const double hours = draws.exponential(plan.session_life_hours, Use::kSessionLife, group, session);
    return std::max(kLifeMin, of_hours(hours));
}

} // namespace scanloom::lab::cluster
