#pragma once

#include "server/live/core/event_encoder.hpp"
#include "server/live/dialogue.hpp"

#include <memory>

namespace scanloom::live {

/// The dialogue of live.proto: the viewer sends LiveRequest, the server LiveEvent.
///
/// The connection is closed with 1003 after a text message, and with 1007 after an invalid LiveRequest.
class EventDialogue final : public Dialogue {
public:
    EventDialogue(const ViewedSession& viewed, const DialogueServices& services)
        : paths_(viewed.paths), landmarks_(viewed.landmarks), services_(services), encoder_(viewed.tag) {}

    [[nodiscard]] std::optional<boost::beast::websocket::close_reason> receive(const ViewerMessage& message) override;
    [[nodiscard]] Turn next(const SessionPtr& session, Clock::time_point now) override;

private:
    [[nodiscard]] Clock::time_point add_landmarks(const SessionPtr& session, SessionSnapshot& snapshot);

    guidance::RobotPaths& paths_;
    std::shared_ptr<WatchedLandmarks> landmarks_;
    DialogueServices services_;
    EventEncoder encoder_;
};

} // namespace scanloom::live
