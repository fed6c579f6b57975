#include "server/session/weave_request.hpp"

#include "common/hash/sha256.hpp"

#include <fmt/format.h>

#include <span>
#include <variant>

namespace scanloom::session {

std::string weave_id_of(const SessionInfo& session, const WeaveRequest& request) {
    std::string text = tag_of(session);
    if (request.end.revision) text += fmt::format(" until {}", *request.end.revision);
    if (request.end.stamp) text += fmt::format(" until {} s", *request.end.stamp);
    // With other exclusions, another scan may be the first one after the stamp.
    if (request.end.stamp && session.exclusions->revision() != 0) {
        text += fmt::format(" excluding {}", session.exclusions->revision());
    }
    for (const auto& field : mapping::config_fields()) {
        std::visit([&](const auto& value) { text += fmt::format("\n{} {}", field.name, value); },
                   mapping::value_of(field, request.config));
    }
    Sha256 hash;
    hash.update(std::as_bytes(std::span(text)));
    return hash.hex().substr(0, 16);
}

} // namespace scanloom::session
