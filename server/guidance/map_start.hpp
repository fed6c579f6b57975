#pragma once

#include "common/scan/log_entry.hpp"
#include "server/sessions/session_info.hpp"

#include <chrono>
#include <map>
#include <mutex>

namespace scanloom::guide {

/// Decides which robot starts the map of a session in which nothing is mapped yet, if several robots ask for their
/// pose.
///
/// The robot that starts the map stands where its operator says. If two robots started a map at the same time, the
/// transform between their poses would be unknown.
/// Threads: any thread.
class MapStart {
public:
    using Clock = std::chrono::steady_clock;

    /// How long a robot that sends nothing prevents other robots from starting the map.
    static constexpr std::chrono::seconds kKept{30};

    /// Returns whether the robot may start the map. It may unless another robot was allowed to within the last kKept.
    [[nodiscard]] bool take(store::SessionId session, RobotIndex robot, Clock::time_point now);

    /// Forgets a session that was deleted.
    void remove(store::SessionId session);

private:
    struct Taken {
        RobotIndex robot;
        Clock::time_point until;
    };

    std::mutex mutex_;
    std::map<store::SessionId, Taken> taken_; // of sessions in which nothing is mapped, and for kKept after that
};

} // namespace scanloom::guide
