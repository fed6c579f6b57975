#pragma once

#include "common/error/error.hpp"
#include "server/auth/token.hpp"

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

namespace scanloom::auth {

/// Permission to use a session while the tokens in force allow it. Granted by Authenticator.
/// Threads: any thread.
class Credential {
public:
    Credential(TokenRef token, Action action, std::string session, std::string user)
        : action_(action), session_(std::move(session)), user_(std::move(user)), hash_(token->hash),
          token_(std::move(token)) {}

    /// Returns the token as it is in force now, or null if it no longer permits this use.
    [[nodiscard]] TokenRef token() const;

    /// Sets the callback for changes of token(). It is called from any thread after each replacement of the tokens, and
    /// at once if one has happened already.
    void when_changed(const std::function<void()>& on_change);

    /// Returns what it permits: kDrive or kRead.
    [[nodiscard]] Action action() const noexcept { return action_; }
    [[nodiscard]] const std::string& session() const noexcept { return session_; }
    [[nodiscard]] const std::string& user() const noexcept { return user_; }
    [[nodiscard]] const std::string& hash() const noexcept { return hash_; }

    /// Sets the token and calls the callback. Only for Authenticator.
    void change(TokenRef token);

private:
    const Action action_;
    const std::string session_;
    const std::string user_; // distinguishes the robots of one token
    const std::string hash_;

    mutable std::mutex mutex_; // guards the following members; held only to copy them
    TokenRef token_;
    bool changed_ = false;
    std::function<void()> on_change_;
};

/// Authenticates clients by their tokens, and grants credentials for robot links and live viewers.
///
/// Without tokens every client is admitted, with the token default_token().
/// Threads: any thread; calls wait only for each other.
class Authenticator {
public:
    /// Creates an authenticator without tokens.
    Authenticator();

    /// Creates an authenticator with tokens; an empty set admits no client.
    explicit Authenticator(TokenSet tokens);

    /// Returns whether the server has no tokens, so that every client is admitted.
    [[nodiscard]] bool is_open() const;

    /// Returns the token of the secret.
    /// Errors: kNoToken if the secret is empty; kUnknownToken if its token is not in force.
    [[nodiscard]] Admitted<TokenRef> admit(std::string_view secret) const;

    /// Returns the token by its secret's hash, or null if it is not in force.
    [[nodiscard]] TokenRef find_hash(std::string_view hash) const;

    /// Permits the robot a link to the session, which need not exist.
    ///
    /// The credential counts as one of the token's connections until it is destroyed. Several credentials for one robot
    /// in one session count once, because the session keeps only the robot's newest link.
    /// Errors: those of admit(); kWrongRole or kWrongSession if the token does not permit it; kLimit if the token's
    ///         `connections` are used up.
    [[nodiscard]] Admitted<std::shared_ptr<Credential>>
    grant_robot_link(std::string_view secret, const std::string& session, const std::string& robot);

    /// Permits an admitted client to watch the session.
    /// Errors: kUnknownToken if the token is no longer in force, kNoToken if it is default_token() and the server has
    ///         tokens now; kWrongRole or kWrongSession if the token does not permit it.
    [[nodiscard]] Admitted<std::shared_ptr<Credential>> grant_viewing(const TokenRef& token,
                                                                      const std::string& session);

    /// Replaces the tokens in force. Credentials that the new tokens do not permit end; the other credentials get their
    /// token's new limits.
    void replace(TokenSet tokens);

private:
    struct Ledger;

    const std::shared_ptr<Ledger> ledger_; // outlives the credentials
};

} // namespace scanloom::auth
