#include "server/http/handlers/session_lookup.hpp"

#include "server/http/in_quotes.hpp"
#include "server/http/number.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

namespace scanloom::http {

Result<std::shared_ptr<session::Session>> find_session(session::SessionRegistry& sessions, const Call& call) {
    const auto& name = call.arguments["session"];
    auto session = sessions.wake(name);
    if (session) return session;
    if (auto damage = damage_of(sessions, name)) return *damage;
    return session.error();
}

std::optional<Error> damage_of(const session::SessionRegistry& sessions, const std::string& name) {
    const auto damaged = sessions.damaged();
    if (const auto found = damaged.find(name); found != damaged.end()) {
        if (found->second.code == Errc::kOverloaded) { // the session itself is intact
            return Error{Errc::kOverloaded,
                         fmt::format("the session {} is not loaded: {}", name, found->second.message)};
        }
        return Error{Errc::kDataLoss,
                     fmt::format("the session {} could not be recovered: {}; waiting will not mend it, DELETE forgets "
                                 "it",
                                 name, found->second.message)};
    }
    return std::nullopt;
}

std::string session_tag(const session::SessionInfo& info, const MakingVersions& versions) {
    const auto tag = fmt::format("{}-{}.{}", session::tag_of(info), versions.weaving, versions.rendering);
    return tag_with(tag, *info.exclusions);
}

std::string tag_with(std::string_view tag, const Exclusions& exclusions) {
    return exclusions.revision() == 0 ? std::string(tag) : fmt::format("{}-x{}", tag, exclusions.revision());
}

Result<mapping::Layer> find_layer(std::string_view name) {
    if (const auto layer = mapping::layer_of(name)) return *layer;
    std::array<std::string_view, mapping::kLayers.size()> names;
    std::ranges::transform(mapping::kLayers, names.begin(), mapping::name_of);
    return Error{Errc::kNotFound,
                 fmt::format("there is no layer {}; possible are {}", in_quotes(name), fmt::join(names, ", "))};
}

Result<mapping::Layer> layer_parameter(const Query& query) {
    return find_layer(query.find("layer").value_or(mapping::name_of(mapping::Layer::kOccupancy)));
}

Result<Revision> since_parameter(const Query& query) {
    const auto text = query.find("since").value_or("0");
    if (const auto since = parse_integer<Revision>(text)) return *since;
    return Error{Errc::kInvalidField, fmt::format("since is {}; a revision is needed, a whole number from 0 to {}",
                                                  in_quotes(text), std::numeric_limits<Revision>::max())};
}

Revision since_in(const mapping::Snapshot& snapshot, Revision since) noexcept {
    return since >= snapshot.exclusions->revision() && since <= snapshot.revision ? since : 0;
}

} // namespace scanloom::http
