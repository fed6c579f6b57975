#include "robot_client/uplink/asking.hpp"

#include "common/net/await_tuple.hpp"

#include <boost/asio/steady_timer.hpp>
#include <boost/asio/this_coro.hpp>

#include <memory>
#include <optional>
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

} // namespace scanloom::robot
