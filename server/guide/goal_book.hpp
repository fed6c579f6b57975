#pragma once

#include "server/mapping/snapshot.hpp"
#include "server/planning/goals.hpp"
#include "server/session/session.hpp"

#include <chrono>
#include <memory>
#include <mutex>
#include <vector>

namespace scanloom::guide {

/// Who pursues which frontier: gives each robot of a session its next goal, and no two of them the same frontier.
///
/// A robot's goal counts until the robot asks again. It counts no longer once the robot has left: a robot that comes
/// back asks again. A goal that was asked for on behalf of a robot that was not connected counts until the robot has
/// connected and left, or for kKeptForAbsent. Nothing of it survives a restart.
/// Goals are kept as places in the map frame: those of maps woven with other cells count, too.
/// Thread  any; one search at a time.
class GoalBook {
public:
    using Clock = std::chrono::steady_clock;

    static constexpr Clock::duration kKeptForAbsent = std::chrono::minutes(1);

    /// The next goal of a robot at `position`, kept for it from now on.
    /// @param maps  the session's, or others woven from its log
    /// Errors  as planning::next_goal(); the robot has no goal then.
    [[nodiscard]] Result<planning::NextGoal> next(const std::shared_ptr<const session::Session>& session,
                                                  const mapping::Snapshot& maps, RobotIndex robot,
                                                  const Point2& position, Clock::time_point now,
                                                  const planning::ExplorationOptions& options = {});

private:
    struct Entry {
        std::weak_ptr<const session::Session> session;
        RobotIndex robot;
        Point2 target; // centre of the frontier's cell, metres
        Clock::time_point given;
        bool was_connected;
    };

    void forget_what_counts_no_longer(Clock::time_point now);

    std::mutex mutex_;
    std::vector<Entry> entries_; // at most one a robot
};

} // namespace scanloom::guide
