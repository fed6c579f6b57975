#pragma once

#include "common/error/error.hpp"
#include "server/session/session_registry.hpp"

#include <chrono>

namespace scanloom::guide {

/// How long a search may go on: until the server shuts down, which waits for it, and no longer than its time, for
/// others wait for it, too.
/// Thread  any one at a time.
class Patience {
public:
    using Clock = std::chrono::steady_clock;

    static constexpr std::chrono::seconds kTime{20};

    explicit Patience(const session::SessionRegistry& sessions, Clock::time_point end = Clock::now() + kTime)
        : sessions_(sessions), end_(end) {}

    /// Errors  kShuttingDown. kTooLarge: what is searched for takes too long.
    [[nodiscard]] Result<> operator()() const {
        if (sessions_.is_draining()) return Error{Errc::kShuttingDown, "the server is shutting down"};
        if (Clock::now() < end_) return {};
        return Error{Errc::kTooLarge,
                     "the search takes too long and was given up: ask for a smaller region, or for rows "
                     "further apart, or plan on a map of larger cells"};
    }

private:
    const session::SessionRegistry& sessions_;
    Clock::time_point end_;
};

} // namespace scanloom::guide
