#pragma once

#include "server/access/token.hpp"
#include "server/session/session_info.hpp"

#include <cstddef>
#include <limits>
#include <string>

namespace scanloom::session {

/// The creator of a session and the limits of its token.
struct Maker {
    std::string token;                                                  ///< name of the token; empty: no token was used
    std::size_t sessions_max = std::numeric_limits<std::size_t>::max(); ///< existing sessions created with the token
    std::size_t chunks_max = SessionLimits::kMost;                      ///< of each session
};

/// Returns the creator that uses `token`, with the limits of the token.
[[nodiscard]] Maker maker_of(const access::Token& token);

} // namespace scanloom::session
