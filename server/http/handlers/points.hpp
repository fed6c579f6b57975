#pragma once

#include "common/error/error.hpp"
#include "server/http/answer_slots.hpp"
#include "server/http/handlers/call.hpp"
#include "server/http/response.hpp"
#include "server/session/session_registry.hpp"
#include "server/store/scan_log.hpp"

namespace scanloom::http {

enum class PointFile { kCsv, kPly };

/// GET .../points.csv and .../points.ply?since&until&robot&threshold: what robots saw from many places as one cloud of
/// points (landmarks::fuse_captures), of the captures that ended after log entry `since`, up to `until`, of all robots
/// or of one; those that are being taken count as ended now. So parts that follow each other have each capture once.
/// Points of different captures at most `threshold` metres apart, 0.05 if not given, become one. Reads the log from its
/// beginning, which takes seconds where it is long.
/// Errors  those of find_session() and read_captures(); kInvalidField: a parameter; kNotFound: no such robot; kTooLarge:
///         the captures have more than a million points, which says what part has not, or it takes more than 5 s.
[[nodiscard]] Result<Response> get_points(session::SessionRegistry& sessions, store::ScanLog& log,
                                          const AnswerSlots& slots, PointFile file, const Call& call);

} // namespace scanloom::http
