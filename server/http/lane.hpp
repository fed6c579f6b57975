#pragma once

#include "server/http/request.hpp"
#include "server/http/response.hpp"

#include <string>
#include <variant>

namespace scanloom::http {

struct Match;
class Query;

/// What a request may have to wait for. Each lane has its own executor, so that no lane delays another.
enum class Lane {
    kAtOnce,    ///< nothing: liveness, readiness, the viewer's files, refusals; runs on the I/O thread
    kTelling,   ///< queries about the process and the store: metrics
    kServing,   ///< computation on a part of a snapshot: tiles (but see look_at_tile()), session data
    kSurvey,    ///< computation on a whole map, up to a second: digests, images, first rendering of tiles that
                ///< cover much
    kPaths,     ///< the disk, and computation on a part of a log, for seconds: trajectories, landmarks
    kLog,       ///< the first small piece of a log; the others follow on this lane as the client reads them
    kWeaving,   ///< maps that a replay job must compute first
    kImporting, ///< as kChanging, with a large body
    kPlanning,  ///< a search in a map, which takes seconds and half a gigabyte in a huge map; one at a time
    kChanging,  ///< the disk, or a session's strand: creating and deleting sessions, making backups
};

[[nodiscard]] Lane lane_of(const Request& request);

/// Returns the lane of a request that has been routed.
[[nodiscard]] Lane lane_of(const Match& match, const Query& query);

/// The request's session must be loaded from the store first.
struct Asleep {
    std::string session;
};

/// What an I/O thread can determine about a request: its response, if that took microseconds and no waiting; the lane
/// that computes the response; or the session that must be loaded first.
using Outlook = std::variant<Lane, Response, Asleep>;

} // namespace scanloom::http
