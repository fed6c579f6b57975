#pragma once

#include "common/scan/scan_filter.hpp"
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
    /// @param filter  which scans are integrated in the session's maps; captures hold no others
    explicit SessionCaptures(ScanFilter filter = ScanFilter()) : filter_(std::move(filter)) {}

    /// Of the entries that are in.
    [[nodiscard]] Revision revision() const noexcept { return revision_; }

    /// Whether a scan that is the next entry may change anything, told without its readings. One that does not is
    /// passed over.
    [[nodiscard]] bool needs(const ScanPose& scan) const noexcept {
        if (filter_.use_of(revision_ + 1, scan) != ScanUse::kIntegrated) return false;
        return scan.robot >= cutters_.size() || cutters_[scan.robot].needs(scan.stamp, scan.pose);
    }
    void pass_over(const ScanPose& scan) { filter_.take(++revision_, scan); }

    /// Adds the next entry. A scan of a sensor that was never described is passed over: only a damaged log has such.
    /// @return the capture that has ended with it
    [[nodiscard]] std::optional<RobotCapture> add(const LogEntry& entry);

    /// Those that are being taken, by robot, as if they ended now.
    [[nodiscard]] std::vector<RobotCapture> open() const;

private:
    std::vector<CaptureCutter> cutters_;                             // by RobotIndex
    std::map<std::pair<RobotIndex, std::uint32_t>, Sensor> sensors_; // by robot and id, as described last
    ScanFilter filter_;
    Revision revision_ = 0;
};

} // namespace scanloom::landmarks
