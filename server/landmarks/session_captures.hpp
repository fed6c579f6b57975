#pragma once

#include "common/scan/jump_filter.hpp"
#include "server/landmarks/capture.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace scanloom::landmarks {

/// A capture, and whose it is.
struct RobotCapture {
    RobotIndex robot = 0;
    Capture capture;
    Revision ended = 0; ///< log entry at which it ended: its last scan or, where the robot moved on, a later one

    friend bool operator==(const RobotCapture&, const RobotCapture&) = default;
};

/// The captures of a session's robots, cut from its log entry by entry.
/// Thread  one at a time.
class SessionCaptures {
public:
    /// @param jumps  which scans are integrated in the session's maps; no others are in captures
    explicit SessionCaptures(JumpFilter jumps = JumpFilter()) : jumps_(std::move(jumps)) {}

    /// Of the entries that are in.
    [[nodiscard]] Revision revision() const noexcept { return revision_; }

    /// Whether a scan that is the next entry may change anything, told without its readings. One that does not is
    /// passed over.
    [[nodiscard]] bool needs(RobotIndex robot, double stamp, const Pose2& pose) const noexcept {
        if (!jumps_.integrates(robot, {pose.x, pose.y})) return false;
        return robot >= cutters_.size() || cutters_[robot].needs(stamp, pose);
    }
    void pass_over(RobotIndex robot, const Pose2& pose) {
        jumps_.take(robot, {pose.x, pose.y});
        ++revision_;
    }

    /// Adds the next entry. A scan of a sensor that was never described is passed over: only a damaged log has such.
    /// @return the capture that has ended with it
    [[nodiscard]] std::optional<RobotCapture> add(const LogEntry& entry);

    /// Those that are being taken, by robot, as if they ended now.
    [[nodiscard]] std::vector<RobotCapture> open() const;

private:
    std::vector<CaptureCutter> cutters_;                             // by RobotIndex
    std::map<std::pair<RobotIndex, std::uint32_t>, Sensor> sensors_; // by robot and id, as described last
    JumpFilter jumps_;
    Revision revision_ = 0;
};

} // namespace scanloom::landmarks
