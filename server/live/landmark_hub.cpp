#include "server/live/landmark_hub.hpp"

#include <boost/asio/post.hpp>

#include <exception>
#include <utility>

namespace scanloom::live {
namespace {

/// Returns whether the search stopped before the end of the log and will continue.
bool is_passing(const Error& error) { return error.code == Errc::kShuttingDown || error.code == Errc::kOverloaded; }

} // namespace

WatchedLandmarks::Look WatchedLandmarks::look(const std::shared_ptr<const sessions::Session>& session,
                                              Revision revision, const LandmarkSearch& search) {
    const std::lock_guard lock(mutex_);
    if (is_finding_ || revision <= searched_) return {found_}; // a notification follows, or nothing is new
    if (Clock::now() < next_) return {found_, next_};
    boost::asio::post(search.executor, [self = shared_from_this(), session, revision, search] {
        self->find(*session, revision, search);
    });
    is_finding_ = true;
    return {found_};
}

/// Runs on the search's executor.
void WatchedLandmarks::find(const sessions::Session& session, Revision revision,
                            const LandmarkSearch& search) noexcept {
    try {
        keep(find_for_a_turn(session, revision, search.turn), revision, search.pause);
    } catch (const std::exception& failure) { // std::bad_alloc
        keep(Error{Errc::kOverloaded, failure.what()}, revision, search.pause);
    }
    session.notify_changed();
}

Result<FoundLandmarks> WatchedLandmarks::find_for_a_turn(const sessions::Session& session, Revision revision,
                                                         std::chrono::milliseconds turn) {
    const auto end = Clock::now() + turn;
    auto applied = layers_.up_to(session.info(), revision, session.snapshot()->scan_poses,
                                 [&] { return Clock::now() < end && !session.closing().has_value(); });
    if (!applied) return applied.error();
    return FoundLandmarks{std::move(applied->state), applied->revision, {}};
}

void WatchedLandmarks::keep(Result<FoundLandmarks> found, Revision revision, std::chrono::milliseconds pause) {
    const std::lock_guard lock(mutex_);
    is_finding_ = false;
    next_ = Clock::now() + pause;
    if (!found && is_passing(found.error())) return;
    searched_ = revision;
    if (!found) {
        const landmarks::LandmarkState before = found_ ? found_->state : landmarks::LandmarkState();
        found = FoundLandmarks{before, found_ ? found_->revision : 0, found.error().message};
    }
    found_ = std::make_shared<const FoundLandmarks>(std::move(*found));
}

std::shared_ptr<WatchedLandmarks> LandmarkHub::of(store::SessionId session) {
    const std::lock_guard lock(mutex_);
    auto& known = watched_[session];
    if (auto watched = known.lock()) return watched;
    auto watched = std::make_shared<WatchedLandmarks>(layers_);
    known = watched;
    std::erase_if(watched_, [](const auto& each) { return each.second.expired(); });
    return watched;
}

} // namespace scanloom::live
