#pragma once

#include "server/store/scan_log.hpp"

#include <map>
#include <optional>
#include <string>

namespace scanloom::session {

/// Returns a unique name for each session of a repaired store.
///
/// A session keeps its name; session 7 becomes "session-7" if its record is lost or cannot be decoded. If several
/// sessions have the same name, because a removed one was recovered, the newest keeps it, and the ids are appended to
/// the others: "kitchen-7".
/// @param records  by id, as found by store::DamagedStore; nullopt: lost
[[nodiscard]] std::map<store::SessionId, std::string>
repaired_names(const std::map<store::SessionId, std::optional<std::string>>& records);

} // namespace scanloom::session
