#include "server/http/handlers/handlers.hpp"

#include "server/http/credentials.hpp"
#include "server/http/host.hpp"
#include "server/http/json_read.hpp"

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>

#include <array>

namespace scanloom::http {
namespace {

boost::json::object token_json(const access::Token& token) {
    boost::json::array sessions;
    for (const auto& pattern : token.sessions) sessions.emplace_back(pattern);
    return {{"name", token.name}, {"role", name_of(token.role)}, {"sessions", std::move(sessions)}};
}

boost::json::object login_json(const Doorman& doorman, const access::TokenRef& token) {
    const bool needed = !doorman.gate().is_open();
    boost::json::value shown;
    if (needed && token) shown = token_json(*token);
    return {{"needed", needed}, {"token", std::move(shown)}};
}

} // namespace

Result<Response> get_login(Context& context) {
    const Doorman& doorman = context.services.doorman;
    if (auto known = context.query.check_only({}); !known) return known.error();
    return ok(login_json(doorman, context.token));
}

Result<Response> post_login(Context& context) {
    const Doorman& doorman = context.services.doorman;
    if (auto known = context.query.check_only({}); !known) return known.error();
    const auto body = parse_json_object(context.request.body);
    if (!body) return body.error();
    constexpr std::array<std::string_view, 1> kMembers = {"token"};
    if (auto known = check_members(*body, kMembers); !known) return known.error();
    const auto secret = read_text(*body, "token");
    if (!secret) return secret.error();
    const auto token = doorman.gate().admit(*secret);
    if (!token) return doorman.refuse(context.request, token.error());
    auto response = ok(login_json(doorman, *token));
    if (!doorman.gate().is_open())
        response.set("Set-Cookie", set_login_cookie(doorman.logins().open(**token), context.request.is_secure));
    return response;
}

Result<Response> delete_login(Context& context) {
    const Doorman& doorman = context.services.doorman;
    if (auto known = context.query.check_only({}); !known) return known.error();
    if (const auto cookie = cookie_of(context.request.cookie, kLoginCookie)) {
        if (!is_own_page(context.request.origin, context.request.host, context.request.is_secure)) {
            return doorman.refuse(
                context.request,
                {access::Reason::kForeignPage, "", {Errc::kUnauthorized, "only a page of this server signs out"}});
        }
        doorman.logins().close(*cookie);
    }
    Response response{.status = Status::no_content, .fields = {}, .body = {}};
    response.set("Set-Cookie", set_login_cookie("", context.request.is_secure));
    return response;
}

} // namespace scanloom::http
