#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_entry.hpp"
#include "core/mapping/map_config.hpp"
#include "core/mapping/projection.hpp"
#include "server/sessions/session_info.hpp"

#include <optional>
#include <string>

namespace scanloom::sessions {

/// The end of a replay job. At most one member has a value; if none has, the job follows its session.
struct ReplayEnd {
    std::optional<Revision> revision; ///< ends after this entry of the log
    std::optional<double> stamp;      ///< seconds; ends before the first scan with a later stamp

    friend bool operator==(const ReplayEnd&, const ReplayEnd&) = default;
};

/// At which poses a replay job shows the scans that robots sent without.
enum class ReplayPoses {
    kThen, ///< as the session's maps showed them at the end of the job
    kNow,  ///< as the session's maps show them now
};

/// The settings and the end of a replay job.
struct ReplayRequest {
    mapping::MapConfig config;
    ReplayEnd end;
    ReplayPoses poses = ReplayPoses::kNow; ///< kNow if the job has no end

    friend bool operator==(const ReplayRequest&, const ReplayRequest&) = default;
};

/// Returns 16 hexadecimal digits that identify a request among those of all sessions. They do not depend on the current
/// revision of the session.
[[nodiscard]] std::string replay_id_of(const SessionInfo& session, const ReplayRequest& request);

/// Returns the revision that the maps of the request must reach.
/// @param newest  current revision of the session
[[nodiscard]] inline Revision target_of(const ReplayRequest& request, Revision newest) {
    return request.end.revision.value_or(newest);
}

/// Checks whether a session with the projection's settings would have accepted a log entry. Links check this when a
/// robot sends the entry; this function checks it for replay jobs, whose settings may differ. Its errors name the robot
/// and the sensor.
///
/// Does not check whether the entry can follow the earlier ones; Projection::apply() does.
/// @param projection  contains the entries before it
/// Errors: kInvalidField if the cells are too small for the range of the sensor or the size of the scan or map.
[[nodiscard]] Result<> check_replayable(const mapping::Projection& projection, const LogEntry& entry);

} // namespace scanloom::sessions
