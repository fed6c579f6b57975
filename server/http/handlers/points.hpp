#pragma once

#include "common/error/error.hpp"
#include "server/http/answer_slots.hpp"
#include "server/http/handlers/call.hpp"
#include "server/http/response.hpp"
#include "server/session/session_registry.hpp"
#include "server/store/scan_log.hpp"

namespace scanloom::http {

enum class PointFile { kCsv, kPly };

/// GET .../points.csv and .../points.ply?since&until&robot&threshold: returns what robots observed from many positions
/// as one point cloud (landmarks::fuse_captures). It contains the captures that ended after log entry `since`, up to
/// `until`, of all robots or of one. Unfinished captures count as ended now. Therefore consecutive parts contain each
/// capture once. Points of different captures are fused if they are at most `threshold` metres apart (default 0.05).
/// Reads the log from its beginning, which takes seconds for a long log.
/// Errors: those of find_session() and read_captures(); kInvalidField for a parameter; kNotFound for the robot;
///         kTooLarge if the captures have more than a million points (the message names a part that has fewer), or if
///         it takes more than 5 s.
[[nodiscard]] Result<Response> get_points(session::SessionRegistry& sessions, store::ScanLog& log,
                                          const AnswerSlots& slots, PointFile file, const Call& call);

} // namespace scanloom::http
