#pragma once

#include "common/error/error.hpp"
#include "server/sessions/session_registry.hpp"

#include <fmt/format.h>

#include <chrono>
#include <string_view>

namespace scanloom::guidance {

/// Limits how long a search in a map or a log may take: it ends when the server shuts down, because the shutdown waits
/// for it, and when its time is over, because other requests wait for it as well.
/// Threads: one at a time.
class SearchLimit {
public:
    static constexpr std::chrono::seconds kTime{20};

    /// Starts the time of a search.
    /// @param sessions  must outlive this object
    /// @param instead   what to request instead to need less time; part of the error message; a string literal
    explicit SearchLimit(const sessions::SessionRegistry& sessions, std::chrono::seconds time = kTime,
                         std::string_view instead = "request a smaller region, or rows further apart, or plan on a map "
                                                    "of larger cells")
        : sessions_(sessions), time_(time), instead_(instead) {}

    /// Returns success while the search may continue.
    /// Errors: kShuttingDown if the server is shutting down; kTooLarge if the search takes too long.
    [[nodiscard]] Result<> operator()() const {
        if (sessions_.is_draining())
            return Error{Errc::kShuttingDown, "the server is shutting down; try again when it is back"};
        if (std::chrono::steady_clock::now() < end_) return {};
        return Error{Errc::kTooLarge, fmt::format("this takes longer than {} s; {}", time_.count(), instead_)};
    }

private:
    const sessions::SessionRegistry& sessions_;
    std::chrono::seconds time_;
    std::chrono::steady_clock::time_point end_ = std::chrono::steady_clock::now() + time_;
    std::string_view instead_;
};

} // namespace scanloom::guidance
