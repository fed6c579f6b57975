#pragma once

#include "server/guard/pass.hpp"
#include "server/guide/way_book.hpp"
#include "server/live/landmark_hub.hpp"
#include "server/session/session.hpp"

#include <functional>
#include <memory>
#include <string>

namespace scanloom::live {

/// To watch a session over the connection that asked for it. Holds no session: one that is deleted is gone. The book,
/// and what finds landmarks, outlive whatever shows sessions.
struct Invitation {
    std::weak_ptr<session::Session> session;
    store::SessionId session_id = 0;
    std::string name; ///< of the session, as its end is told after it is gone
    std::string tag;  ///< LiveEvent::session
    guide::WayBook& ways;
    std::shared_ptr<WatchedLandmarks> landmarks;
    std::function<bool()> is_stored = [] { return false; }; ///< whether the session exists, in memory or not
    std::shared_ptr<guard::Pass> pass = nullptr;            ///< by whose leave; none: nobody takes it back
    std::function<void()> taken_back = [] {}; ///< called when the pass is no longer good, as the viewer ends
};

} // namespace scanloom::live
