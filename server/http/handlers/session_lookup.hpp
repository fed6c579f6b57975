#pragma once

#include "common/error/error.hpp"
#include "server/http/handlers/call.hpp"
#include "server/mapping/projection.hpp"
#include "server/session/session_registry.hpp"
#include "server/tiles/tile_version.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::http {

/// The session of the call's path, read from the store if need be.
/// Errors  those of damage_of() and of SessionRegistry::wake().
[[nodiscard]] Result<std::shared_ptr<session::Session>> find_session(session::SessionRegistry& sessions,
                                                                     const Call& call);

/// Why a session that is stored cannot be served: kDataLoss: its log is damaged; kOverloaded: it could not be read for
/// want of memory. Nothing where there is no such damage.
[[nodiscard]] std::optional<Error> damage_of(const session::SessionRegistry& sessions, const std::string& name);

/// How this program makes maps from logs, and bytes from maps.
struct MakingVersions {
    std::uint32_t weaving = mapping::kWeavingVersion;
    std::uint32_t rendering = tiles::kRenderingVersion;
};

/// What tells a session from every other one, also from one that had its name before, from those of a store that
/// was here before, and from itself as another version of the program shows it: viewers keep what they were told is
/// immutable. In every entity tag of what is made from the session. Begins with what robots are told as session_id.
[[nodiscard]] std::string session_tag(const session::SessionInfo& info, const MakingVersions& versions = {});

/// The tag of maps that these exclusions were applied to: each change of them makes other maps at the same revisions.
[[nodiscard]] std::string tag_with(std::string_view tag, const Exclusions& exclusions);

/// Errors  kNotFound: no such layer.
[[nodiscard]] Result<mapping::Layer> find_layer(std::string_view name);

/// The layer parameter; occupancy when it is not given.
/// Errors  kNotFound: no such layer.
[[nodiscard]] Result<mapping::Layer> layer_parameter(const Query& query);

/// The since parameter, 0 when it is not given.
/// Errors  kInvalidField: not a revision.
[[nodiscard]] Result<Revision> since_parameter(const Query& query);

/// The revision to count from: 0 when `since` has not been reached, as then it is of a session that was deleted, and
/// the client knows nothing of the one that has its name now; and when it is before the newest change of exclusions,
/// which may have changed the maps anywhere.
[[nodiscard]] Revision since_in(const mapping::Snapshot& snapshot, Revision since) noexcept;

} // namespace scanloom::http
