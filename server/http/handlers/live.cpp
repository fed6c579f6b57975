#include "server/http/handlers/handlers.hpp"

#include "server/foxglove/protocol.hpp"
#include "server/http/handlers/lookup.hpp"
#include "server/http/header_fields.hpp"
#include "server/http/problem.hpp"
#include "server/http/text.hpp"
#include "server/live/viewed_session.hpp"

#include <boost/algorithm/string/classification.hpp>
#include <boost/algorithm/string/split.hpp>
#include <boost/algorithm/string/trim.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

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

/// Hands the connection over to a viewer of the session.
Result<Response> view(Context& context, live::Protocol protocol, std::string_view subprotocol) {
    const auto& session = context.session;
    const auto& upgrade = context.request.upgrade;
    if (!is_websocket_key(upgrade->key)) {
        return Error{Errc::kInvalidField, "Sec-WebSocket-Key is not 16 bytes in base64; send a new one each time"};
    }
    const auto& info = session->info();
    auto credential = context.services.authorizer.authenticator().grant_viewing(context.token, info.name);
    if (!credential) return context.services.authorizer.refuse(context.request, credential.error(), info.name);
    live::ViewedSession viewed{
        .session = session,
        .session_id = info.id,
        .name = info.name,
        .tag = session_tag(info),
        .paths = context.services.goals.paths(),
        .landmarks = context.services.watched_landmarks.of(info.id),
        .parts = protocol == live::Protocol::kFoxglove ? context.services.watched_parts.of(info.id) : nullptr,
        .protocol = protocol,
        .subprotocol = std::string(subprotocol)};
    viewed.is_stored = [&sessions = context.services.sessions, id = info.id, name = info.name] {
        const auto stored = sessions.info(name);
        return stored && stored->id == id;
    };
    viewed.credential = std::move(*credential);
    viewed.on_revoked = [authorizer = context.services.authorizer, peer = context.request.peer,
                         token = context.token->name, name = info.name] {
        authorizer.note({auth::Port::kHttp, auth::Reason::kRevoked, peer, token, name});
    };
    Response response;
    response.status = Status::switching_protocols;
    response.viewed = std::make_shared<const live::ViewedSession>(std::move(viewed));
    return response;
}

/// Returns the refusal of a page that may not watch. Browsers let any page open a WebSocket and read it.
/// @param is_allowed  although it is not a page of this server
/// @param remedy      what to do instead
std::optional<Response> refusal_of_page(const Context& context, bool is_allowed, std::string_view remedy) {
    const auto& request = context.request;
    const std::string& origin = request.upgrade->origin;
    if (origin.empty() || is_allowed || is_own_page(origin, request.host, request.is_secure)) return std::nullopt;
    context.services.authorizer.note({auth::Port::kHttp, auth::Reason::kForeignPage, request.peer, context.token->name,
                                      context.session->info().name});
    return problem(Status::forbidden,
                   fmt::format("pages of {} may not watch this server; {}", in_quotes(origin), remedy),
                   instance_of(request.target));
}

bool is_websocket(const Context& context) {
    const auto& upgrade = context.request.upgrade;
    return upgrade && upgrade->version == kVersion;
}

/// Returns the first of kSubprotocols that the viewer offers; empty if it offers none of them.
std::string_view subprotocol_of(std::string_view offered) {
    std::vector<std::string> names;
    boost::algorithm::split(names, offered, boost::algorithm::is_any_of(","));
    for (auto& name : names) boost::algorithm::trim(name);
    for (const std::string_view known : foxglove::kSubprotocols) {
        if (std::ranges::count(names, known) > 0) return known;
    }
    return {};
}

} // namespace

Result<Response> get_live(Context& context) {
    if (!is_websocket(context)) return upgrade_required(context);
    if (auto refusal = refusal_of_page(context, false, "open the viewer that it serves")) return std::move(*refusal);
    return view(context, live::Protocol::kEvents, {});
}

Result<Response> get_foxglove(Context& context) {
    if (!is_websocket(context)) return upgrade_required(context);
    if (auto refusal = refusal_of_page(context, context.request.is_of_viewer_page,
                                       "start the server with --viewer-origin and this origin"))
        return std::move(*refusal);
    const auto subprotocol = subprotocol_of(context.request.upgrade->protocols);
    if (subprotocol.empty()) {
        return Error{Errc::kInvalidField,
                     fmt::format("Sec-WebSocket-Protocol offers none of {}; connect with Foxglove or Lichtblick",
                                 fmt::join(foxglove::kSubprotocols, ", "))};
    }
    return view(context, live::Protocol::kFoxglove, subprotocol);
}

} // namespace scanloom::http
