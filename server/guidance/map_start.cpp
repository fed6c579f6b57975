#include "server/guidance/map_start.hpp"

namespace scanloom::guide {

bool MapStart::take(store::SessionId session, RobotIndex robot, Clock::time_point now) {
    const std::lock_guard lock(mutex_);
    std::erase_if(taken_, [&](const auto& entry) { return entry.second.until <= now; });
    return taken_.try_emplace(session, Taken{robot, now + kKept}).first->second.robot == robot;
}

void MapStart::remove(store::SessionId session) {
    const std::lock_guard lock(mutex_);
    taken_.erase(session);
}

} // namespace scanloom::guide
