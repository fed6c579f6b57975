#include "common/scan/jump_filter.hpp"

namespace scanloom {

bool JumpFilter::integrates(RobotIndex robot, const Point2& place) const noexcept {
    if (!is_on() || robot >= robots_.size() || !robots_[robot].integrated) return true;
    const Robot& known = robots_[robot];
    return norm(place - *known.integrated) <= max_jump_m_ || norm(place - *known.newest) <= max_jump_m_;
}

bool JumpFilter::take(RobotIndex robot, const Point2& place) {
    if (!is_on()) return true;
    const bool is_integrated = integrates(robot, place);
    Robot& known = robot_at(robot);
    known.newest = place;
    if (is_integrated) {
        known.integrated = place;
    } else {
        ++known.left_out;
    }
    return is_integrated;
}

void JumpFilter::restore(RobotIndex robot, const Robot& state) { robot_at(robot) = state; }

JumpFilter::Robot& JumpFilter::robot_at(RobotIndex robot) {
    if (robot >= robots_.size()) robots_.resize(robot + 1);
    return robots_[robot];
}

} // namespace scanloom
