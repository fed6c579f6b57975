#pragma once

#include "server/foxglove/session_feed.hpp"
#include "server/live/dialogue.hpp"

#include <memory>

namespace scanloom::live {

/// The dialogue of Foxglove's protocol. What the viewer does wrong is answered with a warning.
class FoxgloveDialogue final : public Dialogue {
public:
    FoxgloveDialogue(const ViewedSession& viewed, const DialogueServices& services)
        : paths_(viewed.paths), landmarks_(viewed.landmarks), parts_(viewed.parts), services_(services),
          feed_(viewed.name, viewed.tag) {}

    [[nodiscard]] std::optional<boost::beast::websocket::close_reason> receive(const ViewerMessage& message) override;
    [[nodiscard]] Turn next(const SessionPtr& session, Clock::time_point now) override;

private:
    [[nodiscard]] Clock::time_point add_landmarks(const SessionPtr& session, foxglove::SessionView& view);
    [[nodiscard]] Clock::time_point add_parts(const SessionPtr& session, Clock::time_point now,
                                              foxglove::SessionView& view);

    guidance::RobotPaths& paths_;
    std::shared_ptr<WatchedLandmarks> landmarks_;
    std::shared_ptr<WatchedParts> parts_;
    DialogueServices services_;
    foxglove::SessionFeed feed_;
};

} // namespace scanloom::live
