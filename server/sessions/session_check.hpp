#pragma once

#include "common/error/error.hpp"
#include "core/mapping/map_config.hpp"
#include "server/store/scan_log.hpp"

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

namespace scanloom::sessions {

/// How much of a session is checked.
enum class CheckDepth {
    kLog,        ///< each entry: checksum, decoding and order; of the checkpoint only the checksums
    kCheckpoint, ///< also the checkpoint: its parts are decoded as in a recovery
    kMaps,       ///< also the maps: the whole log gives the same maps and poses as the checkpoint and the rest of it
};

/// The result of checking one session.
struct SessionCheck {
    std::string name;            ///< "#7" for session 7 if its record cannot be read
    Revision entries = 0;        ///< intact entries from the start of the log
    std::optional<Error> damage; ///< the first damage found; nullopt: the session is intact
};

/// Called after each entry and each part of a checkpoint with the number of bytes read. An error ends the check.
using CheckPace = std::function<Result<>(std::size_t bytes)>;

/// Checks a stored session. A checkpoint of an earlier version is no damage, because the log can be replayed.
///
/// Memory: negligible for kLog; the session's maps for kCheckpoint; twice as much for kMaps.
/// Errors: those of `pace` only; damage is part of the result.
/// Threads: any thread that may wait for the disk.
[[nodiscard]] Result<SessionCheck> check_session(store::ScanLog& log, const store::StoredSession& stored,
                                                 CheckDepth depth, const CheckPace& pace);

} // namespace scanloom::sessions
