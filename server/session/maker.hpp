#pragma once

#include "server/access/token.hpp"
#include "server/session/session_info.hpp"

#include <cstddef>
#include <limits>
#include <string>

namespace scanloom::session {

/// Who makes a session, and what it may have.
struct Maker {
    std::string token;                                                  ///< its name; empty: nobody in particular
    std::size_t sessions_max = std::numeric_limits<std::size_t>::max(); ///< made with it that exist
    std::size_t chunks_max = SessionLimits::kMost;                      ///< of each
};

[[nodiscard]] Maker maker_of(const access::Token& token);

} // namespace scanloom::session
