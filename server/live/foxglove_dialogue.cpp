#include "server/live/foxglove_dialogue.hpp"

#include <algorithm>
#include <utility>

namespace scanloom::live {
namespace {

/// Adds the goals and paths of robots.
void add_guided(const guidance::RobotPaths::Page& page, foxglove::SessionView& view) {
    view.guided_version = page.revision;
    for (const auto& held : page.robots) {
        foxglove::Guided guided{held.robot, std::nullopt, {}};
        if (held.goal) guided.goal = held.goal->place;
        if (held.path) guided.path = held.path->points;
        view.guided.push_back(std::move(guided));
    }
}

} // namespace

std::optional<boost::beast::websocket::close_reason> FoxgloveDialogue::receive(const ViewerMessage& message) {
    feed_.receive(message.bytes, message.is_text);
    return std::nullopt;
}

Dialogue::Turn FoxgloveDialogue::next(const SessionPtr& session, Clock::time_point now) {
    foxglove::SessionView view{session->snapshot(), session->connected()};
    auto until = paths_.state(session, now).until;
    add_guided(paths_.page(session, now), view);
    until = std::min({until, add_landmarks(session, view), add_parts(session, now, view)});
    Turn turn;
    for (auto& [bytes, rest, is_text] : feed_.next(view, now)) {
        turn.messages.push_back({std::move(bytes), std::move(rest), is_text});
    }
    turn.look_again = std::min(until, feed_.look_again());
    return turn;
}

/// @return when to look for landmarks again
Dialogue::Clock::time_point FoxgloveDialogue::add_landmarks(const SessionPtr& session, foxglove::SessionView& view) {
    if (!feed_.wants_landmarks()) return Clock::time_point::max();
    const auto& config = services_.config;
    const LandmarkSearch search{services_.finding, config.landmarks_pause, config.landmarks_turn};
    const auto look = landmarks_->look(session, view.maps->revision, search);
    if (look.found) {
        view.landmarks = look.found->state.landmarks;
        view.landmarks_revision = look.found->revision;
    }
    return look.until;
}

/// @return when to look for these parts again
Dialogue::Clock::time_point FoxgloveDialogue::add_parts(const SessionPtr& session, Clock::time_point now,
                                                        foxglove::SessionView& view) {
    if (!feed_.wants_parts()) return Clock::time_point::max();
    const auto look = parts_->look(session, now, services_.finding);
    view.map = look.parts->map;
    view.is_map_too_large = look.parts->is_map_too_large;
    view.frontiers = look.parts->frontiers;
    view.graph = look.parts->graph;
    view.parts_revision = look.parts->revision;
    return look.until;
}

} // namespace scanloom::live
