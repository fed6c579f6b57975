#pragma once

#include "common/scan/log_entry.hpp"
#include "server/session/session_info.hpp"

#include <chrono>
#include <map>
#include <mutex>

namespace scanloom::guide {

/// Which robot the map of a session begins with, of those that ask where they are while nothing is mapped. One that is
/// told so stands where its people say it does; two that are told so at once would each begin a map, and nobody would
/// know how the two lie to each other.
/// Thread  any.
class FirstPlaces {
public:
    using Clock = std::chrono::steady_clock;

    /// How long a robot that sends nothing keeps others from beginning.
    static constexpr std::chrono::seconds kKept{30};

    /// Whether the robot may begin: nobody else may, or that was told so kKept ago.
    [[nodiscard]] bool take(store::SessionId session, RobotIndex robot, Clock::time_point now);

    /// The session is deleted: forgets it.
    void remove(store::SessionId session);

private:
    struct Taken {
        RobotIndex robot;
        Clock::time_point until;
    };

    std::mutex mutex_;
    std::map<store::SessionId, Taken> taken_; // those of sessions in which nothing is mapped, and kKept more
};

} // namespace scanloom::guide
