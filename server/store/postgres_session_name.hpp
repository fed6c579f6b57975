#pragma once

#include "server/store/scan_log.hpp"

#include <string>
#include <string_view>

namespace scanloom::store::postgres {

/// What the table `session` repeats of a session's record, so that servers find each other's sessions.
struct SessionName {
    std::string name; ///< empty: the record cannot be decoded
    SessionId replaces =
        0; ///< the session that this one is a copy of, and whose name it has once that is removed; 0: none
};

[[nodiscard]] SessionName name_in(std::string_view record);

} // namespace scanloom::store::postgres
