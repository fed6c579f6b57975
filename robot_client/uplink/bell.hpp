#pragma once

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>

#include <list>

namespace scanloom::robot {

/// Wakes all coroutines that wait for it. Who wakes looks for itself whether anything is new.
/// Thread  one at a time.
class Bell {
public:
    using Time = boost::asio::steady_timer::time_point;

    /// Until it rings, or until then.
    [[nodiscard]] boost::asio::awaitable<void> wait(Time until = Time::max()) {
        const auto waiting = waiting_.emplace(waiting_.end(), co_await boost::asio::this_coro::executor, until);
        co_await waiting->async_wait(boost::asio::as_tuple(boost::asio::use_awaitable));
        waiting_.erase(waiting);
    }

    void ring() {
        for (auto& timer : waiting_) timer.cancel();
    }

private:
    std::list<boost::asio::steady_timer> waiting_;
};

} // namespace scanloom::robot
