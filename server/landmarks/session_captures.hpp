#pragma once

#include "common/scan/scan_filter.hpp"
#include "server/landmarks/capture.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace scanloom::landmarks {

/// A keyframe and the robot that it is from.
struct RobotCapture {
    RobotIndex robot = 0;
    Capture capture;
    Revision ended = 0; ///< log entry at which it ended: its last scan, or a later one if the robot moved on

    friend bool operator==(const RobotCapture&, const RobotCapture&) = default;
};

/// Divides a session's log, entry by entry, into the keyframes of its robots.
/// Threads: one at a time.
class SessionCaptures {
public:
    /// @param filter  selects the scans that are integrated in the session's maps; keyframes contain no others
    explicit SessionCaptures(ScanFilter filter = ScanFilter()) : filter_(std::move(filter)) {}

    /// Returns the revision of the last entry added or skipped.
    [[nodiscard]] Revision revision() const noexcept { return revision_; }

    /// Returns whether a scan, as the next entry, may change anything. The readings are not needed to know. If it
    /// returns false, call pass_over() instead of add().
    [[nodiscard]] bool needs(const ScanPose& scan) const noexcept {
        if (filter_.use_of(revision_ + 1, scan) != ScanUse::kIntegrated) return false;
        return scan.robot >= cutters_.size() || cutters_[scan.robot].needs(scan.stamp, scan.pose);
    }
    /// Skips the next entry.
    void pass_over(const ScanPose& scan) { filter_.take(++revision_, scan); }

    /// Adds the next entry. A scan of a sensor that was never described is skipped: only a damaged log contains one.
    /// @return the keyframe that ended with this entry; nullopt: none ended
    [[nodiscard]] std::optional<RobotCapture> add(const LogEntry& entry);

    /// Returns the keyframes in progress, by robot, as if they ended now.
    [[nodiscard]] std::vector<RobotCapture> open() const;

private:
    std::vector<CaptureCutter> cutters_;                             // by RobotIndex
    std::map<std::pair<RobotIndex, std::uint32_t>, Sensor> sensors_; // by robot and id, as last described
    ScanFilter filter_;
    Revision revision_ = 0;
};

} // namespace scanloom::landmarks
