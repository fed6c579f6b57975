#include "server/live/event_dialogue.hpp"

#include "common/wire/live.hpp"

#include <algorithm>
#include <utility>

namespace scanloom::live {
namespace {

namespace websocket = boost::beast::websocket;

/// Returns the current state of a session, which must not be deleted.
SessionSnapshot snapshot_of(const sessions::Session& session, std::uint64_t goals_revision) {
    SessionSnapshot snapshot{session.snapshot(), session.connected(), wire::LiveState::kOk, {}, goals_revision};
    const auto closing = session.closing();
    const auto failure = session.failure();
    if (closing || failure) {
        snapshot.state = closing ? wire::LiveState::kDraining : wire::LiveState::kFailed;
        snapshot.reason = closing ? closing->message : failure->message;
    }
    return snapshot;
}

} // namespace

std::optional<websocket::close_reason> EventDialogue::receive(const ViewerMessage& message) {
    if (message.is_text) {
        return close_with(websocket::close_code::unknown_data,
                          "a text message was received; send a binary LiveRequest (live.proto)");
    }
    const auto request = wire::decode_live_request(message.bytes);
    if (!request) return close_with(websocket::close_code::bad_payload, request.error().message);
    encoder_.set_subscription(subscription_of(*request));
    return std::nullopt;
}

Dialogue::Turn EventDialogue::next(const SessionPtr& session, Clock::time_point now) {
    const auto paths = paths_.state(session, now);
    SessionSnapshot snapshot = snapshot_of(*session, paths.revision);
    const auto until = std::min(paths.until, add_landmarks(session, snapshot));
    const auto event = encoder_.next(snapshot);
    if (!event) return {{}, until};
    Turn turn{{}, encoder_.has_more() ? now : until};
    turn.messages.push_back({.bytes = wire::encode(*event)});
    return turn;
}

/// @return when to look for landmarks again
Dialogue::Clock::time_point EventDialogue::add_landmarks(const SessionPtr& session, SessionSnapshot& snapshot) {
    if (!encoder_.subscribes_to_landmarks()) return Clock::time_point::max();
    const LandmarkSearch search{services_.finding, services_.config.landmarks_pause, services_.config.landmarks_turn};
    auto look = landmarks_->look(session, snapshot.maps->revision, search);
    snapshot.landmarks = std::move(look.found);
    return look.until;
}

} // namespace scanloom::live
