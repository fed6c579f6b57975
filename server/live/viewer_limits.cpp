#include "server/live/viewer_limits.hpp"

namespace scanloom::live {

std::shared_ptr<const void> ViewerSemaphore::try_take(store::SessionId session) const {
    {
        const std::lock_guard lock(taken_->mutex);
        const auto known = taken_->by_session.find(session);
        const std::size_t of_session = known == taken_->by_session.end() ? 0 : known->second;
        if (taken_->count >= max_ || of_session >= max_of_session_) return nullptr;
        ++taken_->by_session[session];
        ++taken_->count;
    }
    return {taken_.get(), [taken = taken_, session](const void*) { taken->give_back(session); }};
}

void ViewerSemaphore::Taken::give_back(store::SessionId session) {
    const std::lock_guard lock(mutex);
    const auto known = by_session.find(session);
    if (--known->second == 0) by_session.erase(known);
    --count;
}

} // namespace scanloom::live
