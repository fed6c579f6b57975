#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/steady_timer.hpp>

#include <chrono>
#include <functional>
#include <memory>

namespace scanloom::http {

/// A deadline that is moved with every operation and hardly ever passes. Its timer is set anew only when it runs out
/// too early, or would too late: a connection that is used costs no timer.
/// Thread  the executor, a strand, for all.
class Deadline {
public:
    using Clock = std::chrono::steady_clock;

    explicit Deadline(const boost::asio::any_io_executor& executor) : timer_(executor) {}

    /// From now on `passed` is called when a deadline passes, as long as `owner` lives, which holds this.
    void watch(std::weak_ptr<void> owner, std::function<void()> passed);

    /// In place of the one before. Pre: watch() was called.
    void set(Clock::time_point at);
    void set_after(Clock::duration while_) { set(Clock::now() + while_); }

    /// There is none.
    void clear() noexcept { at_ = Clock::time_point::max(); }

    /// Calls nothing any more.
    void stop();

private:
    void arm();

    boost::asio::steady_timer timer_;
    Clock::time_point at_ = Clock::time_point::max();
    Clock::time_point armed_ = Clock::time_point::max(); // when the timer runs out
    std::weak_ptr<void> owner_;
    std::function<void()> passed_;
};

} // namespace scanloom::http
