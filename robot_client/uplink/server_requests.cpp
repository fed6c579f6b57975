#include "robot_client/uplink/server_requests.hpp"

#include "common/net/await_tuple.hpp"
#include "robot_client/sources/seen_points.hpp"

#include <boost/asio/steady_timer.hpp>
#include <boost/asio/this_coro.hpp>

#include <memory>
#include <utility>

namespace scanloom::robot {

namespace asio = boost::asio;

namespace {

/// The state of a request. The uplink may receive the reply after the coroutine was cancelled.
struct Pending {
    asio::steady_timer answered;
    std::optional<link::Reply> reply;
};

} // namespace

asio::awaitable<Result<link::Reply>> ask_once_applied(Uplink& uplink, link::Request request) {
    co_await uplink.until_applied();
    const auto pending = std::make_shared<Pending>(
        Pending{asio::steady_timer(co_await asio::this_coro::executor, asio::steady_timer::time_point::max()), {}});
    const auto asked = uplink.ask(std::move(request), [pending](const link::Reply& reply) {
        pending->reply = reply;
        pending->answered.cancel();
    });
    if (!asked) co_return Error{Errc::kOverloaded, "too many questions to the server are open"};
    try {
        while (!pending->reply) co_await pending->answered.async_wait(kAwaitTuple);
    } catch (...) { // cancelled
        uplink.abandon(*asked);
        throw;
    }
    co_return std::move(*pending->reply);
}

// Goals ---------------------------------------------------------------------------------------------------------------

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

asio::awaitable<Result<NextStop>> ask_for_goal(Uplink& uplink, double body_radius_m) {
    link::Request request = wire::GoalRequest{.body_radius = body_radius_m};
    Result<link::Reply> reply = co_await ask_once_applied(uplink, std::move(request));
    if (!reply) co_return reply.error();
    auto& goal = std::get<wire::GoalReply>(*reply).result;
    if (!goal) co_return goal.error();
    co_return as_stop(std::move(*goal));
}

} // namespace

NextGoal guided_by(Uplink& uplink, double body_radius_m) {
    return [&uplink, body_radius_m] { return ask_for_goal(uplink, body_radius_m); };
}

// Places --------------------------------------------------------------------------------------------------------------

namespace {

asio::awaitable<Result<LocateResult>> ask_for_place(Uplink& uplink, wire::LocateRequest request) {
    link::Request question = std::move(request); // a named variable, because g++ 12 destroys such temporaries twice
    const Result<link::Reply> reply = co_await ask_once_applied(uplink, std::move(question));
    if (!reply) co_return reply.error();
    const auto& correction = std::get<wire::LocateReply>(*reply).result;
    if (!correction) co_return correction.error();
    co_return LocateResult{correction->T_map_odom, correction->explained, correction->position_sigma,
                           correction->yaw_sigma};
}

/// The prior of a locate request. The prior of the first place does not hold for later ones: a robot that was carried
/// away may stand at a place that looks like the first one.
struct Sought {
    std::optional<wire::Near> near;
    Point2 first_place;
    bool is_placed = false;

    void place(const Point2& place) {
        if (near) near = wire::Near{place, kCarriedMax};
        is_placed = true;
    }
};

asio::awaitable<Result<LocateResult>> locate(Uplink& uplink, wire::LocateRequest request,
                                             std::shared_ptr<Sought> sought) {
    const Point2 from = request.from;
    auto located = co_await ask_for_place(uplink, std::move(request));
    if (located) {
        sought->place(transform(located->T_map_odom, from));
    } else if (located.error().code == Errc::kNothingMapped && !sought->is_placed) {
        sought->place(sought->first_place);
    }
    co_return located;
}

} // namespace

Locate located_by(Uplink& uplink, const std::optional<wire::Near>& near, const Point2& first_place) {
    const auto sought = std::make_shared<Sought>(Sought{near, first_place});
    return [&uplink, sought](std::vector<PointMm> points, Point2 from) {
        return locate(uplink, wire::LocateRequest{0, std::move(points), from, sought->near}, sought);
    };
}

} // namespace scanloom::robot
