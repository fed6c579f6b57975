#pragma once

#include "server/auth/audit_log.hpp"
#include "server/auth/authenticator.hpp"
#include "server/auth/token.hpp"

#include <cstddef>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace scanloom::auth {

/// The browsers that are signed in. For each it keeps a hash of the cookie's value and the hash of the token that was
/// used to sign in, never the token's secret.
///
/// Bounds: kLoginsMax in total, kLoginsOfTokenMax per token. Beyond either, the least recently used login is removed.
/// All times are in seconds of a monotonic clock.
class LoginTable {
public:
    static constexpr std::size_t kLoginsMax = 4096;
    static constexpr std::size_t kLoginsOfTokenMax = 64;
    static constexpr double kIdleSeconds = 12.0 * 3600.0; ///< a login expires when unused for longer

    /// Signs a browser in.
    /// @param cookie  a new secret_of() random bits
    void open(std::string_view cookie, const std::string& token_hash, double now);

    /// Records a use of the login.
    /// @return the hash of the token that was used to sign in, or nullopt if the login is unknown or has expired
    [[nodiscard]] std::optional<std::string> use(std::string_view cookie, double now);

    /// Signs the browser out.
    void close(std::string_view cookie);

    [[nodiscard]] std::size_t size() const noexcept { return logins_.size(); }

private:
    struct Login {
        std::string token_hash;
        double used = 0.0;
    };

    void make_room(const std::string& token_hash, double now);

    std::map<std::string, Login, std::less<>> logins_; // by the cookie's hash
};

/// The browsers that are signed in, until this program ends.
/// Threads: any thread.
class LoginSessions {
public:
    /// @param now  a monotonic clock, in seconds
    explicit LoginSessions(std::function<double()> now = steady_seconds) : now_(std::move(now)) {}

    /// Signs a browser in with the token.
    /// @return the value for the browser's cookie
    /// Errors: std::runtime_error if the system has no random bits.
    [[nodiscard]] std::string open(const Token& token);

    /// Records a use of the login, and returns its token as it is in force now.
    /// @return null if the login is unknown or has expired, or if the token is no longer in force
    [[nodiscard]] TokenRef find(std::string_view cookie, const Authenticator& authenticator);

    /// Signs the browser out.
    void close(std::string_view cookie);

private:
    std::function<double()> now_;
    std::mutex mutex_; // guards the table
    LoginTable table_;
};

} // namespace scanloom::auth
