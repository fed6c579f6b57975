#pragma once

#include <atomic>
#include <chrono>
#include <optional>

namespace scanloom::http {

/// Measures how long a connection has waited for its peer, compared with the data that the peer sent or received
/// meanwhile.
/// Threads: begin(), end() and allow() from one thread at a time; behind() from any.
class PeerWait {
public:
    using Clock = std::chrono::steady_clock;

    void begin(Clock::time_point now) noexcept {
        allowed_seconds_ = 0.0;
        since_ = now;
    }

    void end() noexcept { since_ = kNever; }

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

    std::atomic<Clock::time_point> since_ = kNever;
    std::atomic<double> allowed_seconds_ = 0.0;
};

} // namespace scanloom::http
