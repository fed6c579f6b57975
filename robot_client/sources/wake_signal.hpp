#pragma once

#include "common/net/await_tuple.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/this_coro.hpp>

#include <list>
#include <memory>

namespace scanloom::robot {

/// Wakes all coroutines that wait for it. A resumed coroutine checks itself whether anything has changed. A WakeSignal
/// may be destroyed before or after the executor of the waiting coroutines.
/// Threads: one at a time.
class WakeSignal {
public:
    using Time = boost::asio::steady_timer::time_point;

    /// Waits for notify() or until the given time.
    [[nodiscard]] boost::asio::awaitable<void> wait(Time until = Time::max()) {
        const auto waiting = waiting_;
        boost::asio::steady_timer timer(co_await boost::asio::this_coro::executor, until);
        const Place place(*waiting, timer);
        co_await timer.async_wait(kAwaitTuple);
    }

    void notify() {
        for (auto* timer : *waiting_) timer->cancel();
    }

private:
    using Timers = std::list<boost::asio::steady_timer*>; // each on the frame of the coroutine that waits

    class Place {
    public:
        Place(Timers& timers, boost::asio::steady_timer& own)
            : timers_(timers), place_(timers.insert(timers.end(), &own)) {}
        Place(const Place&) = delete;
        Place& operator=(const Place&) = delete;
        ~Place() { timers_.erase(place_); }

    private:
        Timers& timers_;
        Timers::iterator place_;
    };

    std::shared_ptr<Timers> waiting_ = std::make_shared<Timers>();
};

} // namespace scanloom::robot
