#pragma once

#include "robot_client/ros/messages.hpp"

#include <cstdint>
#include <deque>

namespace scanloom::robot {

/// Estimates from the stamps of a periodic topic how many of its messages are missing.
///
/// A step of more than 1.75 of the usual interval, the median of the last ones, is a gap. Steps of more than 10 s are
/// pauses of the sensor, steps back a clock that was set. If every step is a gap for a while, the rate has changed.
/// Threads: one at a time.
class StampGaps {
public:
    /// Adds the stamp of a message. @return number of messages that are missing before it
    std::uint64_t add(RosTime stamp);

    /// Makes the next stamp follow none: messages before it were lost for another reason.
    void restart() { is_begun_ = false; }

    /// Returns the number of missing messages.
    [[nodiscard]] std::uint64_t missing() const noexcept { return missing_; }
    /// Returns in how many gaps they are.
    [[nodiscard]] std::uint64_t gaps() const noexcept { return gaps_; }

private:
    [[nodiscard]] RosTime usual() const;

    std::deque<RosTime> intervals_; // the newest ones that are no gaps
    RosTime newest_ = 0;
    bool is_begun_ = false;
    std::uint64_t missing_ = 0;
    std::uint64_t gaps_ = 0;
    std::uint64_t gaps_in_a_row_ = 0;
};

} // namespace scanloom::robot
