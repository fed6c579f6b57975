#pragma once

#include <atomic>
#include <chrono>
#include <optional>

namespace scanloom::http {

/// How long a connection has been waiting for its peer, compared with what the peer has sent or taken meanwhile.
/// Thread  begin(), end() and allow() from one at a time; behind() from any.
class PeerWait {
public:
    using Clock = std::chrono::steady_clock;

    void begin(Clock::time_point now) noexcept {
        allowed_seconds_ = 0.0;
        since_ = now;
    }

    void end() noexcept { since_ = kNever; }

    /// @param seconds  that what was sent or taken since begin() may take
    void allow(double seconds) noexcept { allowed_seconds_ = seconds; }

    /// Returns the time since begin() minus what was allowed; nullopt while the peer is not waited for.
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
