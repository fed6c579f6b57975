#pragma once

#include "server/auth/authenticator.hpp"
#include "server/guidance/robot_paths.hpp"
#include "server/live/landmark_hub.hpp"
#include "server/live/shared_parts.hpp"
#include "server/sessions/session.hpp"

#include <functional>
#include <memory>
#include <string>

namespace scanloom::live {

/// What is sent over a viewer's WebSocket.
enum class Protocol {
    kEvents,   ///< live.proto
    kFoxglove, ///< the protocol of Foxglove
};

/// What a viewer needs to show a session over its connection. Does not keep the session in memory. `paths` and the
/// LandmarkHub must outlive all viewers.
struct ViewedSession {
    std::weak_ptr<sessions::Session> session;
    store::SessionId session_id = 0;
    std::string name; ///< of the session, for messages after it was deleted
    std::string tag;  ///< LiveEvent::session
    guidance::RobotPaths& paths;
    std::shared_ptr<WatchedLandmarks> landmarks;
    std::shared_ptr<WatchedParts> parts;                    ///< null with Protocol::kEvents
    std::function<bool()> is_stored = [] { return false; }; ///< returns whether the session exists, in memory or not
    std::shared_ptr<auth::Credential> credential = nullptr; ///< permission to watch; null: it cannot be revoked
    Protocol protocol = Protocol::kEvents;
    std::string subprotocol = {};             ///< as the viewer and the server agree in the handshake; empty: none
    std::function<void()> on_revoked = [] {}; ///< called when `credential` was revoked, before the viewer ends
};

} // namespace scanloom::live
