#pragma once

#include "server/store/scan_log.hpp"

#include <map>
#include <optional>
#include <string>

namespace scanloom::session {

/// Each session's name in a repaired store, no two the same: its own; "session-7" for session 7, whose record is lost
/// or cannot be decoded. Where several have one name, as one that was removed came back, the newest keeps it, and the
/// others have their id behind it: "kitchen-7".
/// @param records  by id, as store::Salvage finds them; nothing: it is lost.
[[nodiscard]] std::map<store::SessionId, std::string>
repaired_names(const std::map<store::SessionId, std::optional<std::string>>& records);

} // namespace scanloom::session
