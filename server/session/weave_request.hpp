#pragma once

#include "server/mapping/map_config.hpp"
#include "server/session/session_info.hpp"

#include <optional>
#include <string>

namespace scanloom::session {

/// The end of a replay job. At most one member has a value; if none has, the job follows its session.
struct WeaveEnd {
    std::optional<Revision> revision; ///< ends after this entry of the log
    std::optional<double> stamp;      ///< seconds; ends before the first scan with a later stamp

    friend bool operator==(const WeaveEnd&, const WeaveEnd&) = default;
};

/// The settings and the end of a replay job.
struct WeaveRequest {
    mapping::MapConfig config;
    WeaveEnd end;

    friend bool operator==(const WeaveRequest&, const WeaveRequest&) = default;
};

/// Returns 16 hexadecimal digits that identify a request among those of all sessions. They do not depend on the current
/// revision of the session.
[[nodiscard]] std::string weave_id_of(const SessionInfo& session, const WeaveRequest& request);

/// Returns the revision that the maps of the request must reach.
/// @param newest  current revision of the session
[[nodiscard]] inline Revision target_of(const WeaveRequest& request, Revision newest) {
    return request.end.revision.value_or(newest);
}

} // namespace scanloom::session
