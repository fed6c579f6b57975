#include "server/live/shared_parts.hpp"

#include "server/foxglove/grid_message.hpp"
#include "server/foxglove/scene_messages.hpp"
#include "server/tiles/map_image.hpp"

#include <boost/asio/post.hpp>
#include <spdlog/spdlog.h>

#include <exception>
#include <optional>
#include <utility>

namespace scanloom::live {
namespace {

SharedParts parts_of(const mapping::Snapshot& maps) {
    SharedParts parts;
    parts.revision = maps.revision;
    const double stamp = foxglove::newest_stamp(maps);
    const auto frame = tiles::map_frame(maps, mapping::Layer::kOccupancy, std::nullopt);
    parts.is_map_too_large =
        frame ? frame->cells.width() * frame->cells.height() > kGridCellsMax : frame.error().code == Errc::kTooLarge;
    if (frame && !parts.is_map_too_large) {
        parts.map = std::make_shared<const std::string>(foxglove::grid_message(maps, *frame, stamp));
    }
    parts.frontiers = std::make_shared<const std::string>(foxglove::frontiers_message(maps, stamp));
    return parts;
}

} // namespace

WatchedParts::Look WatchedParts::look(const SessionPtr& session, Clock::time_point now,
                                      const boost::asio::any_io_executor& executor) {
    const std::lock_guard lock(mutex_);
    if (is_computing_ || session->snapshot()->revision <= parts_->revision) return {parts_};
    if (now < next_) return {parts_, next_};
    is_computing_ = true;
    next_ = now + kPause;
    const std::shared_ptr<void> computing(nullptr, [self = shared_from_this()](void*) { // also if the session is gone
        const std::lock_guard ended(self->mutex_);
        self->is_computing_ = false;
    });
    session->read_poses([self = shared_from_this(), weak = std::weak_ptr(session), computing,
                         executor](const localization::SessionPoses& poses) {
        auto graph = std::make_shared<const localization::PoseGraphView>(poses.graph());
        boost::asio::post(executor, [self, weak, computing = computing, graph = std::move(graph)]() mutable {
            const auto watched = weak.lock();
            if (!watched) return;
            self->compute(*watched, std::move(graph));
            computing.reset(); // before viewers look again
            watched->notify_changed();
        });
    });
    return {parts_};
}

/// Runs on the executor of look().
void WatchedParts::compute(const sessions::Session& session,
                           std::shared_ptr<const localization::PoseGraphView> graph) noexcept {
    try {
        SharedParts parts = parts_of(*session.snapshot());
        parts.graph = std::move(graph);
        const std::lock_guard lock(mutex_);
        parts_ = std::make_shared<const SharedParts>(std::move(parts));
    } catch (const std::exception& failure) { // std::bad_alloc: the next change tries again
        spdlog::error("the map of session '{}' was not made for viewers: {}", session.info().name, failure.what());
    }
}

std::shared_ptr<WatchedParts> PartsHub::of(store::SessionId session) {
    const std::lock_guard lock(mutex_);
    auto& known = watched_[session];
    if (auto watched = known.lock()) return watched;
    auto watched = std::make_shared<WatchedParts>();
    known = watched;
    std::erase_if(watched_, [](const auto& each) { return each.second.expired(); });
    return watched;
}

} // namespace scanloom::live
