#include "robot_client/ros/robot_clock.hpp"

#include <algorithm>
#include <cstdlib>

namespace scanloom::robot {
namespace {

constexpr RosTime kClockSecond = 1'000'000'000;
constexpr RosTime kPeriod = 5 * kClockSecond;
constexpr RosTime kLateMax = kClockSecond / 4;    // of messages when clocks agree
constexpr RosTime kAfterStamp = kClockSecond / 5; // of a clock that may be slow or paused

} // namespace

void RobotClock::add(RosTime stamp, RosTime local) {
    if (std::abs(local - period_begin_) > kPeriod) {
        ahead_ = {std::nullopt, ahead_[0]};
        period_begin_ = local;
    }
    ahead_[0] = std::max(ahead_[0].value_or(stamp - local), stamp - local);
    const bool is_set_back = newest_ - stamp > kClockSecond;
    newest_ = is_set_back ? stamp : std::max(newest_, stamp);
}

RosTime RobotClock::now(RosTime local) const {
    const auto ahead = std::max(ahead_[0], ahead_[1]); // nullopt is less than all
    if (!ahead || (*ahead <= 0 && *ahead > -kLateMax)) return local;
    return std::min(local + *ahead, newest_ + kAfterStamp);
}

RosTime RisingStamps::next(RosTime now) {
    const bool is_set_back = newest_ && *newest_ - now > kClockSecond;
    newest_ = newest_ && !is_set_back ? std::max(now, *newest_ + 1) : now;
    return *newest_;
}

} // namespace scanloom::robot
