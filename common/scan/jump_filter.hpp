#pragma once

#include "common/geometry/point2.hpp"
#include "common/scan/log_entry.hpp"

#include <cstdint>
#include <optional>
#include <vector>

namespace scanloom {

/// Leaves out scans whose pose has jumped.
///
/// A scan is not integrated if it is further than max_jump both from its robot's newest integrated scan and from its
/// robot's previous scan. Therefore one wrong pose costs one scan, and so does carrying the robot to another place.
/// Distances are between positions in the map frame; the yaw does not count.
class JumpFilter {
public:
    /// The state that decides on a robot's next scan.
    struct Robot {
        std::optional<Point2> integrated; ///< position of the newest integrated scan
        std::optional<Point2> newest;     ///< position of the newest scan
        std::uint64_t left_out = 0;       ///< number of scans left out

        friend bool operator==(const Robot&, const Robot&) = default;
    };

    /// @param max_jump_m  metres; 0: all scans are integrated
    explicit JumpFilter(double max_jump_m = 0.0) : max_jump_m_(max_jump_m) {}

    [[nodiscard]] bool is_on() const noexcept { return max_jump_m_ > 0.0; }

    /// Returns whether the robot's next scan is integrated if it is taken at `place` (metres, map frame).
    [[nodiscard]] bool integrates(RobotIndex robot, const Point2& place) const noexcept;

    /// Adds the robot's next scan, taken at `place` (metres, map frame), and returns whether it is integrated.
    bool take(RobotIndex robot, const Point2& place);

    [[nodiscard]] Robot state(RobotIndex robot) const { return robot < robots_.size() ? robots_[robot] : Robot{}; }
    void restore(RobotIndex robot, const Robot& state);

private:
    [[nodiscard]] Robot& robot_at(RobotIndex robot);

    double max_jump_m_;
    std::vector<Robot> robots_; // by RobotIndex, up to the last robot with a scan
};

} // namespace scanloom
