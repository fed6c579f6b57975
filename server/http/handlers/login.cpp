#include "server/http/handlers/handlers.hpp"

#include "server/http/header_fields.hpp"
#include "server/http/json_read.hpp"

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>

namespace scanloom::http {
namespace {

boost::json::object token_json(const auth::Token& token) {
    boost::json::array sessions;
    for (const auto& pattern : token.sessions) sessions.emplace_back(pattern);
    return {{"name", token.name}, {"role", name_of(token.role)}, {"sessions", std::move(sessions)}};
}

boost::json::object login_json(const Authorizer& authorizer, const auth::TokenRef& token) {
    const bool needed = !authorizer.authenticator().is_open();
    boost::json::value shown;
    if (needed && token) shown = token_json(*token);
    return {{"needed", needed}, {"token", std::move(shown)}};
}

} // namespace

Result<Response> get_login(Context& context) {
    const Authorizer& authorizer = context.services.authorizer;
    return ok(login_json(authorizer, context.token));
}

Result<Response> post_login(Context& context) {
    const Authorizer& authorizer = context.services.authorizer;
    const auto body = parse_json_object(context.request.body, {"token"});
    if (!body) return body.error();
    const auto secret = read_text(*body, "token");
    if (!secret) return secret.error();
    const auto token = authorizer.authenticator().admit(*secret);
    if (!token) return authorizer.refuse(context.request, token.error());
    auto response = ok(login_json(authorizer, *token));
    if (!authorizer.authenticator().is_open())
        response.set("Set-Cookie", set_login_cookie(authorizer.logins().open(**token), context.request.is_secure));
    return response;
}

Result<Response> delete_login(Context& context) {
    const Authorizer& authorizer = context.services.authorizer;
    if (const auto cookie = cookie_of(context.request.cookie, kLoginCookie)) {
        if (!is_own_page(context.request.origin, context.request.host, context.request.is_secure)) {
            return authorizer.refuse(
                context.request,
                {auth::Reason::kForeignPage, "", {Errc::kUnauthorized, "sign out from a page of this server"}});
        }
        authorizer.logins().close(*cookie);
    }
    return no_content().set("Set-Cookie", set_login_cookie("", context.request.is_secure));
}

} // namespace scanloom::http
