#pragma once

#include "server/http/answer_slots.hpp"
#include "server/http/handlers/call.hpp"
#include "server/http/response.hpp"
#include "server/session/session_registry.hpp"

namespace scanloom::http {

/// GET .../trajectory.geojson?since&times: returns the trajectory of each robot as a feature, in metres of the map
/// frame (RFC 7946 knows only degrees; the foreign members state the difference). With times=true the properties also
/// have the revision, the stamp (seconds, the robot's clock) and the yaw (radians) of each position. `revision` is the
/// end of the trajectories: that of the maps, unless they exceed session::kPathPointsMax. A long trajectory takes a
/// slot, as a large map image does. Points that are not in memory any more are read from the log.
[[nodiscard]] Result<Response> get_trajectory(session::SessionRegistry& sessions, store::ScanLog& log,
                                              const AnswerSlots& slots, const Call& call);

} // namespace scanloom::http
