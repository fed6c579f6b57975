#include "server/http/handlers/session_lookup.hpp"

#include "server/http/in_quotes.hpp"
#include "server/http/number.hpp"
#include "server/http/problem.hpp"

#include <fmt/format.h>

#include <bit>

namespace scanloom::http {
namespace {

/// A bijection that spreads every bit over all. Source: Steele, Lea, Flood (2014), SplitMix64.
std::uint64_t mixed(std::uint64_t bits) {
    bits += 0x9E37'79B9'7F4A'7C15U;
    bits = (bits ^ (bits >> 30)) * 0xBF58'476D'1CE4'E5B9U;
    bits = (bits ^ (bits >> 27)) * 0x94D0'49BB'1331'11EBU;
    return bits ^ (bits >> 31);
}

} // namespace

Result<std::shared_ptr<session::Session>> find_session(const session::SessionRegistry& sessions, const Call& call) {
    const auto& name = call.arguments["session"];
    if (auto session = sessions.find(name)) return session;
    return Error{Errc::kNotFound,
                 fmt::format("there is no session {}; GET /api/v1/sessions lists them", in_quotes(name))};
}

std::optional<Response> refusal_if_damaged(const session::SessionRegistry& sessions, const Call& call) {
    const auto& name = call.arguments["session"];
    if (sessions.find(name)) return std::nullopt;
    const auto damaged = sessions.damaged();
    const auto found = damaged.find(name);
    if (found == damaged.end()) return std::nullopt;
    return problem(Status::internal_server_error,
                   fmt::format("the session {} could not be recovered: {}; waiting will not mend it, DELETE forgets it",
                               name, found->second.message),
                   instance_of(call.request.target));
}

std::string session_tag(const session::SessionInfo& info, const MakingVersions& versions) {
    const auto making = mixed(std::uint64_t{versions.weaving} << 32 | versions.rendering);
    return fmt::format("{:016x}", mixed(mixed(mixed(info.id) ^ std::bit_cast<std::uint64_t>(info.created)) ^ making));
}

Result<> check_layer(std::string_view layer) {
    if (layer == kOccupancy) return {};
    return Error{Errc::kNotFound, fmt::format("there is no layer {}; possible is {}", in_quotes(layer), kOccupancy)};
}

Result<> check_layer_parameter(const Query& query) { return check_layer(query.find("layer").value_or(kOccupancy)); }

Result<Revision> since_parameter(const Query& query) {
    const auto text = query.find("since").value_or("0");
    if (const auto since = parse_integer<Revision>(text)) return *since;
    return Error{Errc::kInvalidField,
                 fmt::format("since is {}; a revision is needed, a whole number from 0 on", in_quotes(text))};
}

Revision since_in(const mapping::Snapshot& snapshot, Revision since) noexcept {
    return since <= snapshot.revision ? since : 0;
}

} // namespace scanloom::http
