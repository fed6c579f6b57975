#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/steady_timer.hpp>

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>

namespace scanloom::http {

/// A deadline that moves with every operation and rarely passes. Its timer is restarted only if it expires before the
/// deadline or would expire after it, so a busy connection restarts no timers.
/// Threads: one executor, a strand, for all calls.
class Deadline {
public:
    using Clock = std::chrono::steady_clock;

    explicit Deadline(const boost::asio::any_io_executor& executor) : timer_(executor) {}

    /// Calls `passed` each time a deadline passes, as long as `owner`, the object that contains this one, is alive.
    void watch(std::weak_ptr<void> owner, std::function<void()> passed);

    /// Replaces the deadline. Must be called after watch().
    void set(Clock::time_point at);
    void set_after(Clock::duration while_) { set(Clock::now() + while_); }

    /// Removes the deadline.
    void clear() noexcept { at_ = Clock::time_point::max(); }

    /// Stops the timer. `passed` is not called any more.
    void stop();

private:
    void arm();

    boost::asio::steady_timer timer_;
    Clock::time_point at_ = Clock::time_point::max();
    Clock::time_point armed_ = Clock::time_point::max(); // when the timer expires
    std::weak_ptr<void> owner_;
    std::function<void()> passed_;
};

/// Whether a connection waits for its peer, and how long compared with the data that the peer sent or received
/// meanwhile.
/// Threads: behind() and stop_measuring() from any; the others from one thread at a time.
class PeerWait {
public:
    using Clock = std::chrono::steady_clock;

    /// Begins to wait, unless the connection waits already.
    void begin(Clock::time_point now) noexcept {
        if (is_waiting_) return;
        is_waiting_ = true;
        allowed_seconds_ = 0.0;
        since_ = now;
    }

    void end() noexcept {
        is_waiting_ = false;
        stop_measuring();
    }

    /// Makes behind() return nullopt until the next begin() after an end().
    void stop_measuring() noexcept { since_ = kNever; }

    [[nodiscard]] bool is_waiting() const noexcept { return is_waiting_; }

    /// @param seconds  the time that the data sent or received since begin() may take
    void allow(double seconds) noexcept { allowed_seconds_ = seconds; }

    /// Returns the time since begin() minus the allowed time, or nullopt between end() and begin().
    [[nodiscard]] std::optional<std::chrono::duration<double>> behind(Clock::time_point now) const noexcept {
        const auto since = since_.load();
        if (since == kNever) return std::nullopt;
        return now - since - std::chrono::duration<double>(allowed_seconds_.load());
    }

private:
    static constexpr auto kNever = Clock::time_point::max();

    bool is_waiting_ = false;
    std::atomic<Clock::time_point> since_ = kNever;
    std::atomic<double> allowed_seconds_ = 0.0;
};

} // namespace scanloom::http
