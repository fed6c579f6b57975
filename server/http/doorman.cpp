#include "server/http/doorman.hpp"

#include "server/http/context.hpp"
#include "server/http/credentials.hpp"
#include "server/http/host.hpp"
#include "server/http/in_quotes.hpp"
#include "server/http/permission.hpp"
#include "server/http/problem.hpp"

#include <fmt/format.h>

#include <string>
#include <utility>

namespace scanloom::http {
namespace {

using access::Reason;
using access::Token;
using access::TokenRef;
using guard::Denied;

Denied denied(Reason reason, const Token& token, std::string why) {
    return {reason, token.name, {Errc::kUnauthorized, std::move(why)}};
}

/// Any page can make a browser send requests here, with the cookie, also from a machine in a private network. Other
/// pages cannot see the response to a request that only reads. All other requests must come from a page of this server.
bool is_of_foreign_page(const Request& request) {
    const bool only_reads = !request.upgrade && (request.method == "GET" || request.method == "HEAD");
    return !only_reads && !is_own_page(request.origin, request.host, request.is_secure);
}

Denied foreign_page(const Request& request, std::string token) {
    return {Reason::kForeignPage,
            std::move(token),
            {Errc::kUnauthorized,
             fmt::format("pages of {} may not do this in your name; use the viewer that this server serves",
                         in_quotes(request.origin))}};
}

bool has_role(const Token& token, Need need) {
    if (need == Need::kCreate || need == Need::kChange || need == Need::kKeep) return may_change(token.role);
    if (need == Need::kGuide) return may_guide(token.role);
    return need == Need::kAll || may_look(token.role);
}

bool is_about_one_session(Need need) { return need == Need::kLook || need == Need::kGuide || need == Need::kChange; }

std::optional<Denied> objection_to(const Token& token, const Match& match) {
    const Need need = need_of(match.operation);
    if (!has_role(token, need)) {
        return denied(Reason::kWrongRole, token,
                      fmt::format("the token '{}' has the role {}, which may not do this; use one of another role",
                                  token.name, name_of(token.role)));
    }
    if ((need == Need::kAll || need == Need::kKeep) && !is_for_all(token)) {
        return denied(
            Reason::kWrongSession, token,
            fmt::format("this is about all sessions, and the token '{}' is not for all; use one whose sessions "
                        "are *",
                        token.name));
    }
    return is_about_one_session(need) ? Doorman::objection(token, match.arguments["session"]) : std::nullopt;
}

std::string_view session_in(const Match& match) {
    return is_about_one_session(need_of(match.operation)) ? std::string_view(match.arguments["session"])
                                                          : std::string_view();
}

} // namespace

std::variant<TokenRef, Response> Doorman::admit(const Request& request, const Match& match) const {
    // Only a program that knows a token sends it in the Authorization field. A browser adds other credentials, for
    // example those for a proxy, by itself.
    const bool has_token = !gate_.is_open() && bearer_of(request.authorization);
    const bool is_told_to = !has_token && !request.origin.empty() && is_of_foreign_page(request);
    const bool asks_no_token = gate_.is_open() || need_of(match.operation) == Need::kNothing;
    if (is_told_to && asks_no_token) return refuse(request, foreign_page(request, ""), session_in(match));
    if (gate_.is_open()) return access::anybody();
    auto who = identify(request);
    if (need_of(match.operation) == Need::kNothing) return who ? *who : nullptr;
    if (!who) return refuse(request, who.error(), session_in(match));
    if (const auto why = objection_to(**who, match)) return refuse(request, *why, session_in(match));
    return *who;
}

std::optional<Denied> Doorman::objection(const Token& token, std::string_view session) {
    if (is_for(token, session)) return std::nullopt;
    return denied(
        Reason::kWrongSession, token,
        fmt::format("the token '{}' is not for this session; use another token or another session", token.name));
}

guard::Admitted<TokenRef> Doorman::identify(const Request& request) const {
    if (!bearer_of(request.authorization)) {
        if (const auto cookie = cookie_of(request.cookie, kLoginCookie)) return identify_browser(request, *cookie);
    }
    return gate_.admit(bearer_of(request.authorization).value_or(""));
}

guard::Admitted<TokenRef> Doorman::identify_browser(const Request& request, std::string_view cookie) const {
    auto token = logins_.find(cookie, gate_);
    if (!token) {
        return Denied{
            Reason::kUnknownToken, "", {Errc::kUnauthorized, "you are signed in no more; sign in again with a token"}};
    }
    if (is_of_foreign_page(request)) return foreign_page(request, token->name);
    return token;
}

/// Source: RFC 6750, section 3.
Response Doorman::refuse(const Request& request, const Denied& why, std::string_view session) const {
    note(request, why, session);
    const auto path = instance_of(request.target);
    if (why.reason == Reason::kNoToken)
        return problem(why.error, path).set("WWW-Authenticate", R"(Bearer realm="scanloom")");
    if (why.reason == Reason::kUnknownToken)
        return problem(why.error, path).set("WWW-Authenticate", R"(Bearer realm="scanloom", error="invalid_token")");
    return problem(Status::forbidden, why.error.message, path);
}

Error Doorman::noted(const Context& context, Error error, std::string_view session) const {
    if (error.code == Errc::kFull) note(context.request, {Reason::kLimit, context.token->name, error}, session);
    return error;
}

void Doorman::note(const Request& request, const Denied& why, std::string_view session) const {
    audit_.note({access::Port::kHttp, why.reason, request.peer, why.token, std::string(session)});
}

} // namespace scanloom::http
