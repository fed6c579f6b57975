#pragma once

#include "server/http/router.hpp"

namespace scanloom::http {

/// What a token has to allow for an operation.
enum class Need {
    kNothing, ///< anybody may; some are told more when they show a token
    kAll,     ///< it is for all sessions
    kKeep,    ///< to keep the whole store: it is for all sessions, and may change them
    kList,    ///< to look at sessions; only those that it is for are shown
    kLook,    ///< to look at this session
    kGuide,   ///< to assign goals to robots of this session
    kCreate,  ///< to change sessions; the handler knows which
    kChange,  ///< to change this session
};

/// The one table of it. Maps that are woven once more change nothing of a session: GET asks for them as well as POST.
[[nodiscard]] Need need_of(Operation operation) noexcept;

} // namespace scanloom::http
