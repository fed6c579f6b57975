#pragma once

#include "server/mapping/map_config.hpp"
#include "server/session/session_info.hpp"

#include <optional>
#include <string>

namespace scanloom::session {

/// Where a weave ends; one of them at most. None: nowhere, it follows its session.
struct WeaveEnd {
    std::optional<Revision> revision; ///< with this entry of the log
    std::optional<double> stamp;      ///< seconds: before the first scan that was taken later

    friend bool operator==(const WeaveEnd&, const WeaveEnd&) = default;
};

/// What is to be woven of a session's log.
struct WeaveRequest {
    mapping::MapConfig config;
    WeaveEnd end;

    friend bool operator==(const WeaveRequest&, const WeaveRequest&) = default;
};

/// Tells a request from all others of all sessions: 16 hexadecimal digits. How far the session is makes no difference.
[[nodiscard]] std::string weave_id_of(const SessionInfo& session, const WeaveRequest& request);

/// The entry that the maps must have at least, asked for when the session is at `newest`.
[[nodiscard]] inline Revision target_of(const WeaveRequest& request, Revision newest) {
    return request.end.revision.value_or(newest);
}

} // namespace scanloom::session
