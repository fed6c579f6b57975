#pragma once

#include "common/scan/log_entry.hpp"
#include "common/scan/log_rules.hpp"

#include <cstdint>
#include <map>
#include <vector>

namespace scanloom::sessions {

/// Makes a valid log from the intact entries of a damaged one.
///
/// The sequence numbers of a robot's scans must have no gaps, so each lost scan is replaced by an empty scan with its
/// number, at the pose of the next scan. The maps are then those of the remaining scans, and a robot that reconnects
/// continues after the last scan. New numbers for the scans would not work: a client would send part of a recording
/// again, and it would be mapped twice. Robots do get new indices, which are used only in the log. A lost ModeChanged
/// entry is added again before the first scan of its mode.
///
/// Some entries cannot be applied without a lost one: scans and sensors of a robot whose RobotJoined entry is lost, and
/// scans of a sensor whose description is lost. The caller stores them elsewhere. If a later description of the same
/// sensor is lost, this is detected only if the scan does not fit the earlier description.
class LogReconstruction {
public:
    /// Adds an intact entry of the old log, in ascending order of revisions.
    /// @return the entries to append to the new log; empty if the entry cannot be applied
    [[nodiscard]] std::vector<LogEntry> add(Revision revision, LogEntry entry);

    /// Returns the number of lost scans that were replaced by empty ones.
    [[nodiscard]] std::uint64_t empty_scans() const noexcept { return empty_scans_; }

    /// Returns the number of entries that are missing in the old log before the last one added.
    [[nodiscard]] std::uint64_t missing() const noexcept { return missing_; }

private:
    [[nodiscard]] bool renumber(LogEntry& entry);
    [[nodiscard]] bool fits(const ScanTaken& taken) const;
    [[nodiscard]] std::vector<LogEntry> lost_before(const ScanTaken& taken) const;

    LogRules rules_;
    std::map<RobotIndex, RobotIndex> robots_;                        // old to new
    std::map<std::pair<RobotIndex, std::uint32_t>, Sensor> sensors_; // by new index and sensor id
    Revision last_ = 0;
    std::uint64_t missing_ = 0;
    std::uint64_t empty_scans_ = 0;
};

} // namespace scanloom::sessions
