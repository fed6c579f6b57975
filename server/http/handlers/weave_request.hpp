#pragma once

#include "common/error/error.hpp"
#include "server/http/target.hpp"
#include "server/sessions/replay_request.hpp"
#include "server/sessions/session.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/json/object.hpp>

#include <span>
#include <string_view>

namespace scanloom::http {

/// Returns the names of the parameters of a replay job: `until`, `poses`, and every setting of a session. They may be
/// parameters of a URL or members of a JSON object.
[[nodiscard]] std::span<const std::string_view> weave_parameters() noexcept;

/// Returns whether any of weave_parameters() is given.
[[nodiscard]] bool has_weave_parameters(const Query& query);

/// Returns the session's own settings with the given ones replaced. The replay job follows the session, or ends
///   until=912                     with entry 912 of its log (a revision)
///   until=976052857.5s            before the first scan with a later stamp on the robots' clocks, in seconds
///   until=2000-12-05T22:27:37Z    the same, for clocks that count from 1970
/// With an end, estimated poses are those of then, or with poses=now those in the session's maps.
/// Errors: kInvalidField, naming the parameter; kConflict if the log has no such entry yet.
[[nodiscard]] Result<sessions::ReplayRequest> weave_request(const sessions::Session& session, const Query& query);
[[nodiscard]] Result<sessions::ReplayRequest> weave_request(const sessions::Session& session,
                                                            const boost::json::object& body);

/// Returns "then" or "now".
[[nodiscard]] std::string_view name_of(sessions::ReplayPoses poses) noexcept;

/// Returns the poses at which the replay job shows the scans that robots sent without.
/// @param maps  of the session
[[nodiscard]] boost::asio::awaitable<mapping::ScanPoses>
poses_for(sessions::Session& session, const sessions::ReplayRequest& request, const mapping::Snapshot& maps);

} // namespace scanloom::http
