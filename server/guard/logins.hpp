#pragma once

#include "server/access/login_table.hpp"
#include "server/access/token.hpp"
#include "server/guard/audit.hpp"
#include "server/guard/gate.hpp"

#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

namespace scanloom::guard {

/// The browsers that are signed in, until this program ends.
/// Threads: any thread.
class Logins {
public:
    /// @param now  a monotonic clock, in seconds
    explicit Logins(std::function<double()> now = steady_seconds) : now_(std::move(now)) {}

    /// Signs a browser in with the token.
    /// @return the value for the browser's cookie
    /// Errors: std::runtime_error if the system has no random bits.
    [[nodiscard]] std::string open(const access::Token& token);

    /// Records a use of the login, and returns its token as it is in force now.
    /// @return null if the login is unknown or has expired, or if the token is no longer in force
    [[nodiscard]] access::TokenRef find(std::string_view cookie, const Gate& gate);

    /// Signs the browser out.
    void close(std::string_view cookie);

private:
    std::function<double()> now_;
    std::mutex mutex_; // guards the table
    access::LoginTable table_;
};

} // namespace scanloom::guard
