#pragma once

#include "robot_client/ros/messages.hpp"

#include <array>
#include <optional>

namespace scanloom::robot {

/// The robot's clock, as the stamps of its messages show it: the clock of this machine, or that of a simulation, which
/// may be years off.
///
/// Messages arrive a little after their stamps, so the robot's clock is ahead of this machine's by at least the
/// largest difference of the last seconds. If that is less than a second, the clocks agree.
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
