#include "robot_client/uplink/guidance.hpp"

#include "robot_client/uplink/asking.hpp"

#include <utility>

namespace scanloom::robot {

namespace asio = boost::asio;

namespace {

NextStop as_stop(wire::Goal goal) {
    switch (goal.exploration) {
    case wire::Exploration::kGoal:
        return {NextStop::Outcome::kGoal, std::move(goal.path->points), *goal.target}; // always present with a goal
    case wire::Exploration::kTakenByOthers: return {NextStop::Outcome::kTakenByOthers, {}, {0.0, 0.0}};
    case wire::Exploration::kComplete: break;
    }
    return {NextStop::Outcome::kComplete, {}, {0.0, 0.0}};
}

asio::awaitable<Result<NextStop>> ask(Uplink& uplink, double body_radius_m) {
    link::Request request = wire::GoalRequest{.body_radius = body_radius_m};
    Result<link::Reply> reply = co_await ask_once_applied(uplink, std::move(request));
    if (!reply) co_return reply.error();
    auto& goal = std::get<wire::GoalReply>(*reply).goal;
    if (!goal) co_return goal.error();
    co_return as_stop(std::move(*goal));
}

} // namespace

NextGoal guided_by(Uplink& uplink, double body_radius_m) {
    return [&uplink, body_radius_m] { return ask(uplink, body_radius_m); };
}

} // namespace scanloom::robot
