#pragma once

#include "robot_client/ros/messages.hpp"

#include <array>
#include <optional>

namespace scanloom::robot {

/// The robot's clock, as the stamps of its messages show it: the clock of this machine, or that of a simulation, which
/// may be years off, slow, or paused.
///
/// Messages arrive after their stamps, so the robot's clock is ahead of this machine's by at least the largest
/// difference of the last seconds. If the newest message seems to be a quarter of a second old at most, the clocks
/// agree and messages were that late. A clock that does not agree may be a slow or paused one: its time is never more
/// than 0.2 s after the newest stamp.
/// Threads: one at a time.
class RobotClock {
public:
    /// Adds the stamp of a message.
    /// @param local  when it arrived by this machine's clock, in ns
    void add(RosTime stamp, RosTime local);

    /// Returns the robot's time; `local` before the first stamp.
    /// @param local  this machine's time, in ns
    [[nodiscard]] RosTime now(RosTime local) const;

private:
    std::array<std::optional<RosTime>, 2> ahead_; // largest difference in this period and in the one before
    RosTime period_begin_ = 0;
    RosTime newest_ = 0; // stamp
};

/// Stamps for a topic: none comes twice, and they never decrease unless the clock was set back.
/// Threads: one at a time.
class RisingStamps {
public:
    /// Returns the stamp of the next message.
    [[nodiscard]] RosTime next(RosTime now);

private:
    std::optional<RosTime> newest_;
};

} // namespace scanloom::robot
