#pragma once

#include "server/foxglove/session_feed.hpp"
#include "server/live/dialogue.hpp"

#include <memory>

namespace scanloom::live {

/// The dialogue of Foxglove's protocol. What the viewer does wrong is answered with a remark.
class FoxgloveDialogue final : public Dialogue {
public:
    FoxgloveDialogue(const ViewedSession& viewed, const DialogueServices& services)
        : paths_(viewed.paths), landmarks_(viewed.landmarks), services_(services), feed_(viewed.name, viewed.tag) {}

    [[nodiscard]] std::optional<boost::beast::websocket::close_reason> receive(const ViewerMessage& message) override;
    [[nodiscard]] Turn next(const SessionPtr& session, Clock::time_point now) override;

private:
    class WatchedGraph;

    guidance::RobotPaths& paths_;
    std::shared_ptr<WatchedLandmarks> landmarks_;
    DialogueServices services_;
    foxglove::SessionFeed feed_;
    std::shared_ptr<WatchedGraph> graph_; ///< shared with a session that still reads it; null: not wanted yet
};

} // namespace scanloom::live
