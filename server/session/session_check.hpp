#pragma once

#include "common/error/error.hpp"
#include "server/mapping/map_config.hpp"
#include "server/store/scan_log.hpp"

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

namespace scanloom::session {

/// How much of a session is looked at.
enum class CheckDepth {
    kLog,        ///< every entry: checksum, decoding, and that each can follow; of the checkpoint the checksums
    kCheckpoint, ///< also the parts of the checkpoint, decoded as a start does
    kMaps,       ///< also the maps: those of the whole log are those of the checkpoint and the rest
};

/// What was found of one session.
struct SessionCheck {
    std::string name;            ///< "#7" for session 7, where its record cannot be read
    Revision entries = 0;        ///< that are whole, from the first on
    std::optional<Error> damage; ///< the first there is; nothing: it is whole
};

/// Called with the bytes read after each entry and each part of a checkpoint; its error ends the check.
using CheckPace = std::function<Result<>(std::size_t bytes)>;

/// Reads a session as it is stored, damaged or not.
///
/// A checkpoint of an earlier version is no damage: the log is woven anew. Memory: nothing of note for kLog; for the
/// others the session's maps, for kMaps twice.
/// Errors  those of `pace`, and nothing else: what is wrong with the session is in the answer.
/// Thread  any; waits for the disk.
[[nodiscard]] Result<SessionCheck> check_session(store::ScanLog& log, const store::StoredSession& stored,
                                                 CheckDepth depth, const CheckPace& pace);

} // namespace scanloom::session
