#include "server/http/handlers/live.hpp"

#include "server/http/handlers/session_lookup.hpp"
#include "server/http/host.hpp"
#include "server/http/in_quotes.hpp"
#include "server/http/problem.hpp"
#include "server/live/invitation.hpp"

#include <fmt/format.h>

#include <memory>

namespace scanloom::http {
namespace {

constexpr std::string_view kVersion = "13"; // RFC 6455

Response upgrade_required(const Call& call) {
    return problem(Status::upgrade_required, "this is a WebSocket; ask for it with Upgrade: websocket, version 13",
                   instance_of(call.request.target))
        .set("Upgrade", "websocket")
        .set("Connection", "Upgrade")
        .set("Sec-WebSocket-Version", kVersion);
}

} // namespace

Result<Response> get_live(session::SessionRegistry& sessions, guide::WayBook& ways, live::LandmarkHub& landmarks,
                          const Doorman& doorman, const Call& call) {
    if (auto known = call.query.check_only({}); !known) return known.error();
    const auto session = find_session(sessions, call);
    if (!session) return session.error();
    const auto& upgrade = call.request.upgrade;
    if (!upgrade || upgrade->version != kVersion) return upgrade_required(call);
    if (!is_websocket_key(upgrade->key)) {
        return Error{Errc::kInvalidField, "Sec-WebSocket-Key is not 16 bytes in base64; send a new one each time"};
    }
    if (!upgrade->origin.empty() && !is_own_page(upgrade->origin, call.request.host, call.request.is_secure)) {
        doorman.note({access::Port::kHttp, access::Reason::kForeignPage, call.request.peer, call.token->name,
                      (*session)->info().name});
        return problem(Status::forbidden,
                       fmt::format("pages of {} may not watch this server; open the viewer that it serves",
                                   in_quotes(upgrade->origin)),
                       instance_of(call.request.target));
    }
    const auto& info = (*session)->info();
    auto pass = doorman.gate().let_watch(call.token, info.name);
    if (!pass) return doorman.refuse(call.request, pass.error(), info.name);
    Response response;
    response.status = Status::switching_protocols;
    response.invitation = std::make_shared<const live::Invitation>(
        live::Invitation{*session, info.id, info.name, session_tag(info), ways, landmarks.of(info.id),
                         [&sessions, id = info.id, name = info.name] {
                             const auto stored = sessions.info(name);
                             return stored && stored->id == id;
                         },
                         std::move(*pass),
                         [doorman, peer = call.request.peer, token = call.token->name, name = info.name] {
                             doorman.note({access::Port::kHttp, access::Reason::kRevoked, peer, token, name});
                         }});
    return response;
}

} // namespace scanloom::http
