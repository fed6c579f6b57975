#include "robot_client/uplink/guidance.hpp"

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>

#include <memory>
#include <optional>

namespace scanloom::robot {

namespace asio = boost::asio;

namespace {

/// What is waited for. The uplink may hear the answer when nobody waits any more.
struct Pending {
    asio::steady_timer answered;
    std::optional<Result<wire::Goal>> goal;
};

NextStop as_stop(wire::Goal goal) {
    switch (goal.exploration) {
    case wire::Exploration::kGoal:
        return {NextStop::Outcome::kGoal, std::move(goal.path->points), *goal.target}; // they come with a goal
    case wire::Exploration::kTakenByOthers: return {NextStop::Outcome::kTakenByOthers, {}, {0.0, 0.0}};
    case wire::Exploration::kComplete: break;
    }
    return {NextStop::Outcome::kComplete, {}, {0.0, 0.0}};
}

asio::awaitable<Result<NextStop>> ask(Uplink& uplink, double body_radius_m) {
    co_await uplink.until_applied();
    const auto pending = std::make_shared<Pending>(
        Pending{asio::steady_timer(co_await asio::this_coro::executor, asio::steady_timer::time_point::max()), {}});
    wire::GoalRequest request;
    request.body_radius = body_radius_m;
    const auto asked = uplink.ask(request, [pending](const Reply& reply) {
        pending->goal = std::get<wire::GoalReply>(reply).goal;
        pending->answered.cancel();
    });
    if (!asked) co_return Error{Errc::kOverloaded, "too many questions to the server are open"};
    while (!pending->goal) co_await pending->answered.async_wait(asio::as_tuple(asio::use_awaitable));
    if (!*pending->goal) co_return pending->goal->error();
    co_return as_stop(std::move(**pending->goal));
}

} // namespace

NextGoal guided_by(Uplink& uplink, double body_radius_m) {
    return [&uplink, body_radius_m] { return ask(uplink, body_radius_m); };
}

} // namespace scanloom::robot
