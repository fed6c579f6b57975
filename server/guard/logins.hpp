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

/// Browsers that are signed in, while this program runs.
/// Thread  any.
class Logins {
public:
    explicit Logins(std::function<double()> now = steady_seconds) : now_(std::move(now)) {}

    /// @return what the browser's cookie is to hold.
    [[nodiscard]] std::string open(const access::Token& token);

    /// The token, as it is in force now; null when the browser is signed in no more, or the token is gone.
    [[nodiscard]] access::TokenRef find(std::string_view cookie, const Gate& gate);

    void close(std::string_view cookie);

private:
    std::function<double()> now_;
    std::mutex mutex_; // guards the table
    access::LoginTable table_;
};

} // namespace scanloom::guard
