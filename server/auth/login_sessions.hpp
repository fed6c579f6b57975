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

/// Returns the time in seconds since 1970, UTC.
[[nodiscard]] double unix_seconds();

/// The browsers that are signed in, until this program ends.
///
/// If servers share a secret, a browser that has signed in at one of them is signed in at all, for kIdleSeconds after
/// it signed in, and longer at those that it uses. Signing out removes the browser's cookie, but only the server that
/// was asked refuses a copy of it, until it ends. So the bounds of the table do not end such a login.
/// Threads: any thread.
class LoginSessions {
public:
    /// @param now   a monotonic clock, in seconds
    /// @param date  the time in seconds since 1970, UTC, which the servers have in common
    explicit LoginSessions(std::function<double()> now = steady_seconds, std::function<double()> date = unix_seconds)
        : now_(std::move(now)), date_(std::move(date)) {}

    /// Sets the secret of the servers that share a database. Call before any other function; without a call, this
    /// server alone accepts its cookies.
    void share(std::string secret) { secret_ = std::move(secret); }

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
    void adopt(std::string_view cookie, double now);

    std::function<double()> now_;
    std::function<double()> date_;
    std::string secret_; // empty: logins are not shared
    std::mutex mutex_;   // guards the members below
    LoginTable table_;
    std::map<std::string, double, std::less<>> closed_; // shared logins that ended here: hash of the cookie, time
};

} // namespace scanloom::auth
