#pragma once

#include "common/link/server_protocol.hpp"
#include "server/auth/authenticator.hpp"

#include <functional>
#include <memory>
#include <string>

namespace scanloom::ingest {

/// The permission of one robot's link, from the hello to the end of the link. Applies the limits of the robot's token
/// to the link's protocol, and ends the link when its token no longer permits it. Has no socket and no clock.
/// Threads: one at a time; `on_change` from any thread.
class LinkPermission {
public:
    using Time = link::ServerProtocol::Time;

    /// Receives each refusal, for the audit log.
    using OnRefused =
        std::function<void(auth::Reason reason, const std::string& token_name, const std::string& session)>;

    /// @param authenticator  outlives this object
    /// @param protocol       of the link; outlives this object
    /// @param on_refused     called from the other functions
    LinkPermission(auth::Authenticator& authenticator, link::ServerProtocol& protocol, OnRefused on_refused)
        : authenticator_(authenticator), protocol_(protocol), on_refused_(std::move(on_refused)) {}

    /// Authenticates the robot. Call it before the session is looked up, so that a refused client does not learn which
    /// sessions exist.
    /// @param hello      names the token, the session and the robot
    /// @param now        the current time
    /// @param on_change  called after each later change of the token; then call apply()
    /// Errors: kUnauthorized, or kOverloaded if the token's `connections` are used up.
    [[nodiscard]] Result<> request(const wire::Hello& hello, Time now, const std::function<void()>& on_change);

    /// Applies the token, which may have changed. Fails the protocol if the token no longer permits the link. Has no
    /// effect before request() has succeeded and after release().
    void apply(Time now);

    /// Records that the robot reached a limit of its token. Pre: request() has succeeded.
    void record_limit() const { on_refused_(auth::Reason::kLimit, token_->name, session_); }

    /// The link has ended: it no longer counts as one of the token's connections.
    void release() noexcept { credential_.reset(); }

    /// Returns the token that last permitted the link; null before request() has succeeded.
    [[nodiscard]] const auth::TokenRef& token() const noexcept { return token_; }

private:
    auth::Authenticator& authenticator_;
    link::ServerProtocol& protocol_;
    OnRefused on_refused_;
    std::shared_ptr<auth::Credential> credential_; // from request() to release()
    auth::TokenRef token_;
    std::string session_;
};

} // namespace scanloom::ingest
