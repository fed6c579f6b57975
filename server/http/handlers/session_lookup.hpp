#pragma once

#include "common/error/error.hpp"
#include "server/http/handlers/call.hpp"
#include "server/mapping/projection.hpp"
#include "server/session/session_registry.hpp"
#include "server/tiles/tile.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::http {

/// Returns the session in the call's path. Loads it from the store if necessary.
/// Errors: those of damage_of() and SessionRegistry::wake().
[[nodiscard]] Result<std::shared_ptr<session::Session>> find_session(session::SessionRegistry& sessions,
                                                                     const Call& call);

/// Returns why a stored session cannot be served, or nullopt: kDataLoss if its log is damaged, kOverloaded if memory
/// ran out while loading it.
[[nodiscard]] std::optional<Error> damage_of(const session::SessionRegistry& sessions, const std::string& name);

/// Versions of the algorithms that compute maps from logs, and bytes from maps.
struct MakingVersions {
    std::uint32_t weaving = mapping::kWeavingVersion;
    std::uint32_t rendering = tiles::kRenderingVersion;
};

/// Returns a tag that differs from that of every other session, of an earlier session of the same name, of the sessions
/// of an earlier store, and of the same session as another version of the program shows it, because viewers cache
/// immutable responses. It is part of every entity tag of data of the session. It begins with the session_id that
/// robots receive.
[[nodiscard]] std::string session_tag(const session::SessionInfo& info, const MakingVersions& versions = {});

/// Returns the tag of maps with these exclusions. Each change of the exclusions changes the maps at the same revisions.
[[nodiscard]] std::string tag_with(std::string_view tag, const Exclusions& exclusions);

/// Errors: kNotFound if there is no such layer.
[[nodiscard]] Result<mapping::Layer> find_layer(std::string_view name);

/// Returns the layer parameter, or occupancy if it is not given.
/// Errors: kNotFound if there is no such layer.
[[nodiscard]] Result<mapping::Layer> layer_parameter(const Query& query);

/// Returns the since parameter, or 0 if it is not given.
/// Errors: kInvalidField if it is not a revision.
[[nodiscard]] Result<Revision> since_parameter(const Query& query);

/// Returns the revision from which to report changes: usually `since`. Returns 0 if the session has not reached
/// `since`, because then the client knows only a deleted session of this name; and if `since` is before the newest
/// change of exclusions, which may have changed the maps anywhere.
[[nodiscard]] Revision since_in(const mapping::Snapshot& snapshot, Revision since) noexcept;

} // namespace scanloom::http
