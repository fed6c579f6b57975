#pragma once

#include "common/error/error.hpp"
#include "server/session/session_registry.hpp"

#include <fmt/format.h>

#include <chrono>
#include <string_view>

namespace scanloom::guide {

/// How long a search may go on: until the server shuts down, which waits for it, and no longer than its time, for
/// others wait for it, too.
/// Thread  any one at a time.
class Patience {
public:
    using Clock = std::chrono::steady_clock;

    static constexpr std::chrono::seconds kTime{20};

    /// @param instead  what to ask for that takes less time: a literal
    explicit Patience(const session::SessionRegistry& sessions, Clock::time_point end = Clock::now() + kTime,
                      std::string_view instead =
                          "ask for a smaller region, or for rows further apart, or plan on a map "
                          "of larger cells")
        : sessions_(sessions), end_(end), instead_(instead) {}

    /// Errors  kShuttingDown. kTooLarge: what is searched for takes too long.
    [[nodiscard]] Result<> operator()() const {
        if (sessions_.is_draining()) return Error{Errc::kShuttingDown, "the server is shutting down"};
        if (Clock::now() < end_) return {};
        return Error{Errc::kTooLarge, fmt::format("the search takes too long and was given up: {}", instead_)};
    }

private:
    const session::SessionRegistry& sessions_;
    Clock::time_point end_;
    std::string_view instead_;
};

} // namespace scanloom::guide
