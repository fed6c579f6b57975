#pragma once

#include "server/auth/audit_log.hpp"
#include "server/auth/authenticator.hpp"
#include "server/auth/login_sessions.hpp"
#include "server/auth/token.hpp"
#include "server/http/request.hpp"
#include "server/http/response.hpp"
#include "server/http/routes.hpp"

#include <string>
#include <string_view>
#include <utility>
#include <variant>

namespace scanloom::http {

struct Context;

/// Identifies the sender of a request and checks that its token permits the operation.
///
/// A client that may not see a session receives the same response whether or not that session exists.
/// Threads: any. All referenced objects must outlive this one.
class Authorizer {
public:
    Authorizer(auth::Authenticator& authenticator, auth::AuditLog& audit, auth::LoginSessions& logins)
        : authenticator_(authenticator), audit_(audit), logins_(logins) {}

    /// Checks the credentials of a request and the permission for its operation.
    /// @param session  in the path, if the permission is about one session
    /// @return the token, null for an unknown client if the operation needs no token; or the response that refuses
    [[nodiscard]] std::variant<auth::TokenRef, Response> admit(const Request& request, Access access,
                                                               std::string_view session) const;

    /// Writes the refusal to the audit log.
    /// @return 401 with WWW-Authenticate if the request had no known token, else 403
    [[nodiscard]] Response refuse(const Request& request, const auth::Denied& why, std::string_view session = {}) const;

    /// Writes a client without a valid certificate to the audit log.
    /// @param peer  its address
    void note(const std::string& peer, net::ClientFault fault) const { audit_.note(auth::Port::kHttp, peer, fault); }

    /// Writes a refusal to the audit log.
    void note(auth::Refusal refusal) const { audit_.note(std::move(refusal)); }

    /// Returns `error` unchanged. Writes it to the audit log if a limit is reached (kFull).
    [[nodiscard]] Error noted(const Context& context, Error error, std::string_view session) const;

    [[nodiscard]] auth::Authenticator& authenticator() const noexcept { return authenticator_; }
    [[nodiscard]] auth::LoginSessions& logins() const noexcept { return logins_; }

private:
    void note(const Request& request, const auth::Denied& why, std::string_view session) const;
    [[nodiscard]] auth::Admitted<auth::TokenRef> identify(const Request& request) const;
    [[nodiscard]] auth::Admitted<auth::TokenRef> identify_browser(const Request& request,
                                                                  std::string_view cookie) const;

    auth::Authenticator& authenticator_;
    auth::AuditLog& audit_;
    auth::LoginSessions& logins_;
};

} // namespace scanloom::http
