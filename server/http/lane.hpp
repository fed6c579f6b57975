#pragma once

#include "server/http/request.hpp"
#include "server/http/response.hpp"

#include <string>
#include <variant>

namespace scanloom::http {

struct Match;
class Query;

/// What an answer may have to wait for; each lane has an executor of its own, so that none holds up another.
enum class Lane {
    kAtOnce,    ///< nothing: liveness, readiness, the viewer's files, refusals; on the I/O thread itself
    kTelling,   ///< a look at the system: metrics
    kServing,   ///< its own work on a part of a snapshot: tiles (but see look_at_tile()), facts
    kSurvey,    ///< its own work on a whole map, which may take a second: digests, images, first drawings of tiles that
                ///< show much
    kPaths,     ///< the disk, and its own work on a part of a log, which may take seconds: paths of robots, landmarks
    kLog,       ///< a small piece of a log: its first one; the others follow there as the reader takes them
    kWeaving,   ///< maps that are to be woven first
    kImporting, ///< as kChanging, with a large body
    kPlanning,  ///< a search through a map, which takes seconds and half a gigabyte where it is huge: one at a time
    kChanging,  ///< the disk, or a session's strand: creating and deleting sessions, making backups
};

[[nodiscard]] Lane lane_of(const Request& request);

/// The same once it is routed.
[[nodiscard]] Lane lane_of(const Match& match, const Query& query);

/// The session that a request is about has to be read from the store first.
struct Asleep {
    std::string session;
};

/// What is known of a request on the I/O thread: its answer, where that took microseconds and no waiting; the lane on
/// which the answer is to be made; or that its session has to be woken before that can be told.
using Outlook = std::variant<Lane, Response, Asleep>;

} // namespace scanloom::http
