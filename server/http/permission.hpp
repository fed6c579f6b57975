#pragma once

#include "server/http/router.hpp"

namespace scanloom::http {

/// The permission that an operation requires of a token.
enum class Need {
    kNothing, ///< none; some responses contain more if the request has a token
    kAll,     ///< the token is for all sessions
    kKeep,    ///< to back up the store: the token is for all sessions and may change them
    kList,    ///< to read sessions; only those that the token is for are returned
    kLook,    ///< to read this session
    kGuide,   ///< to assign goals to robots of this session
    kCreate,  ///< to change sessions; the handler checks which
    kChange,  ///< to change this session
};

/// Returns the permission for an operation. A replay job does not change its session: it needs the same permission with
/// GET as with POST.
[[nodiscard]] Need need_of(Operation operation) noexcept;

} // namespace scanloom::http
