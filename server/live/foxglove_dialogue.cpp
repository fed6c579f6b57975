#include "server/live/foxglove_dialogue.hpp"

#include <algorithm>
#include <mutex>
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

/// The pose graph of a session, which its strand reads at most every two seconds while there are new scans.
/// Threads: any.
class FoxgloveDialogue::WatchedGraph : public std::enable_shared_from_this<FoxgloveDialogue::WatchedGraph> {
public:
    /// Adds the newest graph that is known to the view. Reads a newer one if the session has new entries; the session's
    /// watchers are notified when it is there.
    /// @return when to call this again
    Clock::time_point look(const SessionPtr& session, Clock::time_point now, foxglove::SessionView& view) {
        const std::lock_guard lock(mutex_);
        view.graph = graph_;
        view.graph_version = version_;
        const Revision revision = view.maps->revision;
        if (is_reading_ || revision <= read_) return Clock::time_point::max();
        if (now < next_) return next_;
        is_reading_ = true;
        next_ = now + kPause;
        session->read_poses([self = shared_from_this(), weak = std::weak_ptr(session),
                             revision](const localization::SessionPoses& poses) {
            self->keep(poses.graph(), revision);
            if (const auto watched = weak.lock()) watched->notify_changed();
        });
        return Clock::time_point::max();
    }

private:
    static constexpr std::chrono::seconds kPause{2};

    void keep(localization::PoseGraphView graph, Revision revision) {
        const std::lock_guard lock(mutex_);
        graph_ = std::make_shared<const localization::PoseGraphView>(std::move(graph));
        ++version_;
        read_ = revision;
        is_reading_ = false;
    }

    std::mutex mutex_;
    std::shared_ptr<const localization::PoseGraphView> graph_;
    std::uint64_t version_ = 0;
    Revision read_ = 0; ///< entries that the graph has
    bool is_reading_ = false;
    Clock::time_point next_; ///< earliest next reading
};

std::optional<boost::beast::websocket::close_reason> FoxgloveDialogue::receive(const ViewerMessage& message) {
    feed_.receive(message.bytes, message.is_text);
    return std::nullopt;
}

Dialogue::Turn FoxgloveDialogue::next(const SessionPtr& session, Clock::time_point now) {
    foxglove::SessionView view{session->snapshot(), session->connected()};
    auto until = paths_.state(session, now).until;
    add_guided(paths_.page(session, now), view);
    if (feed_.wants_landmarks()) {
        const auto& config = services_.config;
        const LandmarkSearch search{services_.finding, config.landmarks_pause, config.landmarks_turn};
        const auto look = landmarks_->look(session, view.maps->revision, search);
        until = std::min(until, look.until);
        if (look.found) {
            view.landmarks = look.found->state.landmarks;
            view.landmarks_revision = look.found->revision;
        }
    }
    if (feed_.wants_pose_graph()) {
        if (!graph_) graph_ = std::make_shared<WatchedGraph>();
        until = std::min(until, graph_->look(session, now, view));
    }
    Turn turn;
    for (auto& [bytes, is_text] : feed_.next(view, now)) turn.messages.push_back({std::move(bytes), is_text});
    turn.look_again = std::min(until, feed_.look_again());
    return turn;
}

} // namespace scanloom::live
