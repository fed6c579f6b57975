#pragma once

#include "server/http/answer_slots.hpp"
#include "server/http/handlers/call.hpp"
#include "server/http/response.hpp"
#include "server/session/session_registry.hpp"

namespace scanloom::http {

/// GET .../trajectory.geojson?since&times: where each robot was, one feature a robot, in metres of the map
/// frame (RFC 7946 knows only degrees; the foreign members say so). With times=true its properties tell of each
/// position also the revision, the stamp (seconds, the robot's clock) and the yaw (radians). `revision` is up to where
/// paths are told: that of the maps, unless they are longer than session::kPathPointsMax. A long path takes a slot, as
/// a large map image does; what is in memory no more is read from the log.
[[nodiscard]] Result<Response> get_trajectory(session::SessionRegistry& sessions, store::ScanLog& log,
                                              const AnswerSlots& slots, const Call& call);

} // namespace scanloom::http
