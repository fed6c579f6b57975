#include "server/http/authorizer.hpp"

#include "server/http/context.hpp"
#include "server/http/header_fields.hpp"
#include "server/http/problem.hpp"
#include "server/http/text.hpp"

#include <fmt/format.h>

#include <optional>
#include <string>
#include <utility>

namespace scanloom::http {
namespace {

using auth::Action;
using auth::Denied;
using auth::Reason;
using auth::Token;
using auth::TokenRef;

/// Any page can make a browser send requests here, with the cookie, also from a machine in a private network. Other
/// pages cannot see the response to a request that only reads. All other requests must come from a page of this server.
bool is_of_foreign_page(const Request& request) {
    const bool only_reads = !request.upgrade && (request.method == "GET" || request.method == "HEAD");
    const bool may_watch = request.upgrade && request.is_of_viewer_page;
    return !only_reads && !may_watch && !is_own_page(request.origin, request.host, request.is_secure);
}

Denied foreign_page(const Request& request, std::string token) {
    return {Reason::kForeignPage,
            std::move(token),
            {Errc::kUnauthorized,
             fmt::format("pages of {} may not send this request; use the viewer that this server serves",
                         in_quotes(request.origin))}};
}

/// Returns the action that an access requires of the token's role, or nullopt if every role permits it.
std::optional<Action> action_of(Access access) {
    switch (access) {
    case Access::kCreate:
    case Access::kChange:
    case Access::kOperate: return Action::kChange;
    case Access::kGuide: return Action::kGuide;
    case Access::kList:
    case Access::kRead: return Action::kRead;
    case Access::kOpen:
    case Access::kServer: break;
    }
    return std::nullopt;
}

auth::Admitted<void> check_access(const Token& token, Access access, std::string_view session) {
    if (const auto action = action_of(access)) {
        const auto concerned = is_about_one_session(access) ? std::optional(session) : std::nullopt;
        if (auto permitted = check_permission(token, *action, concerned); !permitted) return permitted;
    }
    if ((access != Access::kServer && access != Access::kOperate) || is_for_all(token)) return {};
    return Denied{
        Reason::kWrongSession, token.name,
        Error{Errc::kUnauthorized, fmt::format("this needs a token for all sessions, and the token '{}' is not one; "
                                               "use a token whose sessions are *",
                                               token.name)}};
}

} // namespace

std::variant<TokenRef, Response> Authorizer::admit(const Request& request, Access access,
                                                   std::string_view session) const {
    // Only a program that knows a token sends it in the Authorization field. A browser adds other credentials, for
    // example those for a proxy, by itself.
    const bool has_token = !authenticator_.is_open() && bearer_of(request.authorization);
    const bool is_foreign = !has_token && !request.origin.empty() && is_of_foreign_page(request);
    const bool needs_token = !authenticator_.is_open() && access != Access::kOpen;
    if (is_foreign && !needs_token) return refuse(request, foreign_page(request, ""), session);
    if (authenticator_.is_open()) return auth::default_token();
    auto who = identify(request);
    if (access == Access::kOpen) return who ? *who : nullptr;
    if (!who) return refuse(request, who.error(), session);
    if (const auto permitted = check_access(**who, access, session); !permitted)
        return refuse(request, permitted.error(), session);
    return *who;
}

auth::Admitted<TokenRef> Authorizer::identify(const Request& request) const {
    if (!bearer_of(request.authorization)) {
        if (const auto cookie = cookie_of(request.cookie, kLoginCookie)) return identify_browser(request, *cookie);
    }
    return authenticator_.admit(bearer_of(request.authorization).value_or(""));
}

auth::Admitted<TokenRef> Authorizer::identify_browser(const Request& request, std::string_view cookie) const {
    auto token = logins_.find(cookie, authenticator_);
    if (!token) {
        return Denied{
            Reason::kUnknownToken, "", {Errc::kUnauthorized, "your sign-in has expired; sign in again with a token"}};
    }
    if (is_of_foreign_page(request)) return foreign_page(request, token->name);
    return token;
}

/// Source: RFC 6750, section 3.
Response Authorizer::refuse(const Request& request, const Denied& why, std::string_view session) const {
    note(request, why, session);
    const auto path = instance_of(request.target);
    if (why.reason == Reason::kNoToken)
        return problem(why.error, path).set("WWW-Authenticate", R"(Bearer realm="scanloom")");
    if (why.reason == Reason::kUnknownToken)
        return problem(why.error, path).set("WWW-Authenticate", R"(Bearer realm="scanloom", error="invalid_token")");
    return problem(Status::forbidden, why.error.message, path);
}

Error Authorizer::noted(const Context& context, Error error, std::string_view session) const {
    if (error.code == Errc::kFull) note(context.request, {Reason::kLimit, context.token->name, error}, session);
    return error;
}

void Authorizer::note(const Request& request, const Denied& why, std::string_view session) const {
    audit_.note({auth::Port::kHttp, why.reason, request.peer, why.token, std::string(session)});
}

} // namespace scanloom::http
