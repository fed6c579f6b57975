#include "lab/cluster_plan.hpp"

#include <fmt/format.h>

namespace scanloom::lab::cluster {
namespace {

Error impossible(std::string message) { return {Errc::kInvalidField, std::move(message)}; }

double robot_starts(const Plan& plan) {
    const double lives = plan.session_life_hours > 0.0 ? plan.duration_hours / plan.session_life_hours : 0.0;
    return static_cast<double>(plan.robots) * (1.0 + lives);
}

} // namespace

Result<> check(const Plan& plan) {
    if (plan.session_size > static_cast<double>(plan.robots)) {
        return impossible(fmt::format("--session-size {:g} is more than --robots {}; give it at most as many robots",
                                      plan.session_size, plan.robots));
    }
    if (plan.upgrade_at_hours >= plan.duration_hours) {
        return impossible(fmt::format("--upgrade-at {:g} is not within the {:g} hours of --duration; upgrade earlier, "
                                      "or simulate longer",
                                      plan.upgrade_at_hours, plan.duration_hours));
    }
    if (robot_starts(plan) > kRobotStartsMax) {
        return impossible(fmt::format("--duration {:g} with --session-life {:g} is {:.0f} starts of robots, more than "
                                      "{:.0f}; simulate a shorter time, or let sessions live longer",
                                      plan.duration_hours, plan.session_life_hours, robot_starts(plan),
                                      kRobotStartsMax));
    }
    return {};
}

} // namespace scanloom::lab::cluster
