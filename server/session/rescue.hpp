#pragma once

#include "common/scan/log_entry.hpp"
#include "common/scan/log_rules.hpp"

#include <cstdint>
#include <map>
#include <vector>

namespace scanloom::session {

/// Makes a log that can be woven of what is left of one: its intact entries, in order, with others missing between
/// them.
///
/// A scan must follow the scan before it, or nothing behind a lost one could be kept. So each scan that is missing is
/// stood in for by one of its number that shows nothing, at the pose of the next: maps are those of the scans that are
/// left, and a robot that comes back goes on behind the last one, as if none had been lost. Numbering the scans anew
/// instead would have a recording sent again in part, and mapped twice. Robots are numbered anew, which only the log
/// knows of.
///
/// What cannot be woven any more is for the caller to set aside: scans and sensors of a robot whose joining is lost,
/// scans of a sensor whose description is lost. That a sensor was described again, otherwise, cannot be seen where that
/// entry is lost, unless the scan does not fit.
class Rescue {
public:
    /// An entry of the old log, by rising revision.
    /// @return what takes its place in the new one; nothing: it cannot be woven.
    [[nodiscard]] std::vector<LogEntry> add(Revision revision, LogEntry entry);

    /// So many scans were stood in for.
    [[nodiscard]] std::uint64_t stood_in() const noexcept { return stood_in_; }

    /// Of the old log, up to the last one added.
    [[nodiscard]] std::uint64_t missing() const noexcept { return missing_; }

private:
    [[nodiscard]] bool renumber(LogEntry& entry);
    [[nodiscard]] bool fits(const ScanTaken& taken) const;
    [[nodiscard]] std::vector<LogEntry> stand_ins_before(const ScanTaken& taken);

    LogRules rules_;
    std::map<RobotIndex, RobotIndex> robots_;                        // old to new
    std::map<std::pair<RobotIndex, std::uint32_t>, Sensor> sensors_; // by the new
    Revision last_ = 0;
    std::uint64_t missing_ = 0;
    std::uint64_t stood_in_ = 0;
};

} // namespace scanloom::session
