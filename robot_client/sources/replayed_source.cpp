#include "robot_client/sources/replayed_source.hpp"

#include <boost/asio/post.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>

namespace scanloom::robot {

namespace asio = boost::asio;

asio::awaitable<Result<std::optional<Observation>>> ReplayedSource::next() {
    co_await asio::post(co_await asio::this_coro::executor,
                        asio::use_awaitable); // lets other handlers of the thread run
    if (is_stopped_) co_return std::optional<Observation>{};
    co_return recording_->next();
}

} // namespace scanloom::robot
