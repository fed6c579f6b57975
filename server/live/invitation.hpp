#pragma once

#include "server/session/session.hpp"

#include <memory>
#include <string>

namespace scanloom::live {

/// To watch a session over the connection that asked for it. Holds no session: one that is deleted is gone.
struct Invitation {
    std::weak_ptr<session::Session> session;
    store::SessionId session_id = 0;
    std::string name; ///< of the session, as its end is told after it is gone
    std::string tag;  ///< LiveEvent::session
};

} // namespace scanloom::live
