#pragma once

#include "common/error/error.hpp"
#include "core/mapping/projection.hpp"
#include "core/mapping/snapshot.hpp"
#include "server/http/context.hpp"
#include "server/http/target.hpp"
#include "server/sessions/replay_jobs.hpp"
#include "server/sessions/session_registry.hpp"
#include "server/tiles/map_image.hpp"
#include "server/tiles/tile.hpp"

#include <boost/asio/awaitable.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::http {

/// Returns why a stored session cannot be served, or nullopt: kDataLoss if its log is damaged, kOverloaded if memory
/// ran out while loading it.
[[nodiscard]] std::optional<Error> damage_of(const sessions::SessionRegistry& sessions, const std::string& name);

/// Returns the session in the path, in memory or not.
/// Errors: kNotFound; those of damage_of().
[[nodiscard]] Result<sessions::ListedSession> find_listed(const Context& context);

/// Versions of the algorithms that compute maps from logs, and bytes from maps.
struct MakingVersions {
    std::uint32_t projection = mapping::kProjectionVersion;
    std::uint32_t rendering = tiles::kRenderingVersion;
};

/// Returns a tag that differs from that of every other session, of an earlier session of the same name, of the sessions
/// of an earlier store, and of the same session as another version of the program shows it, because viewers cache
/// immutable responses. It is part of every entity tag of data of the session. It begins with the session_id that
/// robots receive.
[[nodiscard]] std::string session_tag(const sessions::SessionInfo& info, const MakingVersions& versions = {});

/// Returns the tag of maps with these exclusions. Each change of the exclusions changes the maps at the same revisions.
[[nodiscard]] std::string tag_with(std::string_view tag, const Exclusions& exclusions);

/// The maps that a request refers to.
struct Maps {
    std::shared_ptr<sessions::Session> session;
    std::shared_ptr<const mapping::Snapshot> snapshot;
    std::shared_ptr<const void> origin; ///< their producer: the session or the replay job
    std::string tag;                    ///< unique among all sessions and replay jobs; for entity tags
};

/// The maps that a request compares.
struct TwoMaps {
    Maps a;
    Maps b;
};

/// Whether a lookup may wait until the session's own maps have been written, for a few milliseconds.
enum class Waiting { kAllowed, kNotAllowed };

/// Returns existing maps: the session's own, or the newest that the replay job `weave` has finished.
/// @param waiting  kNotAllowed: without a snapshot while the session's own maps are being written
/// Errors: kNotFound if there is no such job; kOverloaded if it has no maps yet; the job's own error if it
///         failed.
[[nodiscard]] Result<Maps> find_maps(const Context& context, Waiting waiting = Waiting::kAllowed);

/// Returns what find_maps() returns if no settings are given. Otherwise starts a replay job with the settings, waits
/// until it has reached the session's current revision, and continues on the same executor.
/// Errors: those of find_maps(), weave_request() and WorkClasses::wait_for_replay().
[[nodiscard]] boost::asio::awaitable<Result<Maps>> find_maps_or_replay(Context& context);

/// Returns two maps to compare, those of the parameters `weave` and `with`. At least one of them must name a replay
/// job; an absent one means the session's own map. Both may name the same job.
/// Errors: those of find_maps(); kInvalidField if neither is given.
[[nodiscard]] Result<TwoMaps> find_two_maps(const Context& context);

/// Errors: kNotFound if there is no such replay job.
[[nodiscard]] Result<std::shared_ptr<sessions::ReplayJob>>
find_weave(sessions::ReplayJobs& weaves, const sessions::Session& session, std::string_view id);

/// Suspends the coroutine until the session's maps show all corrected poses, at most for Services::replay_timeout.
/// Errors: kOverloaded if they do not by then.
[[nodiscard]] boost::asio::awaitable<Result<>> wait_for_corrections(Context& context);

} // namespace scanloom::http
