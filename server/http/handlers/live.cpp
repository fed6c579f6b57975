#include "server/http/handlers/handlers.hpp"

#include "server/http/handlers/lookup.hpp"
#include "server/http/header_fields.hpp"
#include "server/http/problem.hpp"
#include "server/http/text.hpp"
#include "server/live/viewed_session.hpp"

#include <fmt/format.h>

#include <memory>

namespace scanloom::http {
namespace {

constexpr std::string_view kVersion = "13"; // RFC 6455

Response upgrade_required(const Context& context) {
    return problem(Status::upgrade_required,
                   "this address is a WebSocket; request it with Upgrade: websocket, version 13",
                   instance_of(context.request.target))
        .set("Upgrade", "websocket")
        .set("Connection", "Upgrade")
        .set("Sec-WebSocket-Version", kVersion);
}

} // namespace

Result<Response> get_live(Context& context) {
    const auto& session = context.session;
    const auto& upgrade = context.request.upgrade;
    if (!upgrade || upgrade->version != kVersion) return upgrade_required(context);
    if (!is_websocket_key(upgrade->key)) {
        return Error{Errc::kInvalidField, "Sec-WebSocket-Key is not 16 bytes in base64; send a new one each time"};
    }
    // Browsers let any page open a WebSocket and read it.
    if (!upgrade->origin.empty() && !is_own_page(upgrade->origin, context.request.host, context.request.is_secure)) {
        context.services.authorizer.note({auth::Port::kHttp, auth::Reason::kForeignPage, context.request.peer,
                                          context.token->name, session->info().name});
        return problem(Status::forbidden,
                       fmt::format("pages of {} may not watch this server; open the viewer that it serves",
                                   in_quotes(upgrade->origin)),
                       instance_of(context.request.target));
    }
    const auto& info = session->info();
    auto credential = context.services.authorizer.authenticator().grant_viewing(context.token, info.name);
    if (!credential) return context.services.authorizer.refuse(context.request, credential.error(), info.name);
    Response response;
    response.status = Status::switching_protocols;
    response.viewed = std::make_shared<const live::ViewedSession>(
        live::ViewedSession{session, info.id, info.name, session_tag(info), context.services.goals.paths(),
                            context.services.watched_landmarks.of(info.id),
                            [&sessions = context.services.sessions, id = info.id, name = info.name] {
                                const auto stored = sessions.info(name);
                                return stored && stored->id == id;
                            },
                            std::move(*credential),
                            [authorizer = context.services.authorizer, peer = context.request.peer,
                             token = context.token->name, name = info.name] {
                                authorizer.note({auth::Port::kHttp, auth::Reason::kRevoked, peer, token, name});
                            }});
    return response;
}

} // namespace scanloom::http
