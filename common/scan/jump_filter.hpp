#pragma once

#include "common/geometry/point2.hpp"
#include "common/scan/log_entry.hpp"

#include <cstdint>
#include <optional>
#include <vector>

namespace scanloom {

/// Which scans of a log are integrated: a scan further than max_jump from its robot's newest integrated scan, and from
/// its robot's scan before it, is left out. So one pose that is wrong costs one scan, and a robot that was carried
/// elsewhere one, too. Distances are those of poses in the map frame, without yaw.
class JumpFilter {
public:
    /// What decides about a robot's next scan.
    struct Robot {
        std::optional<Point2> integrated; ///< place of the newest integrated scan
        std::optional<Point2> newest;     ///< place of the newest scan
        std::uint64_t left_out = 0;       ///< scans

        friend bool operator==(const Robot&, const Robot&) = default;
    };

    /// @param max_jump_m  metres; 0: all scans are integrated
    explicit JumpFilter(double max_jump_m = 0.0) : max_jump_m_(max_jump_m) {}

    [[nodiscard]] bool is_on() const noexcept { return max_jump_m_ > 0.0; }

    /// Whether the robot's next scan, if it is taken at that place, is integrated.
    [[nodiscard]] bool integrates(RobotIndex robot, const Point2& place) const noexcept;

    /// The robot's next scan. @return integrates() of it
    bool take(RobotIndex robot, const Point2& place);

    [[nodiscard]] Robot state(RobotIndex robot) const { return robot < robots_.size() ? robots_[robot] : Robot{}; }
    void restore(RobotIndex robot, const Robot& state);

private:
    [[nodiscard]] Robot& robot_at(RobotIndex robot);

    double max_jump_m_;
    std::vector<Robot> robots_; // by RobotIndex; none beyond the last that took a scan
};

} // namespace scanloom
