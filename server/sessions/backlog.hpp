#pragma once

#include "common/scan/log_entry.hpp"
#include "core/mapping/reach.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <vector>

namespace scanloom::sessions {

/// A validated entry that is not yet in the log and the maps.
struct PendingEntry {
    static constexpr RobotIndex kNoRobot = std::numeric_limits<RobotIndex>::max(); ///< the entry is the server's own

    RobotIndex robot = 0;          ///< that sent it; or kNoRobot
    std::optional<LogEntry> entry; ///< nullopt: a duplicate that is not stored and only holds credit
    mapping::Reach reach;          ///< of a scan
    std::size_t bytes = 0;         ///< credit that is returned when the entry is in the maps
};

/// Entries that are appended to the log together and then applied.
struct Group {
    std::vector<PendingEntry> entries;
    std::int64_t chunks = 0; ///< upper bound of the map chunks that the group creates
    double work = 0.0;       ///< in the unit of Reach::work
};

/// Bounds of a group. They limit the wait for an acknowledgement and the work that a restart repeats.
inline constexpr std::size_t kGroupEntriesMax = 256;
inline constexpr double kGroupWorkMax = mapping::kScanWorkMax;

/// Queue of entries that wait to be appended to the log. Its size is bounded by the credit of the links.
class Backlog {
public:
    void add(PendingEntry entry) { waiting_.push_back(std::move(entry)); }

    [[nodiscard]] bool empty() const noexcept { return waiting_.empty(); }
    [[nodiscard]] std::size_t size() const noexcept { return waiting_.size(); }
    [[nodiscard]] const PendingEntry& front() const { return waiting_.front(); }

    /// Removes and returns the next group, which creates at most `room` chunks. The group is empty if the first entry
    /// alone might create more.
    [[nodiscard]] Group next_group(std::int64_t room);

    /// Puts the group back to the front. It must be the group that next_group() returned last.
    void put_back(Group group);

    /// Removes all entries of the robot.
    void drop(RobotIndex robot);
    void clear() { waiting_.clear(); }

private:
    std::deque<PendingEntry> waiting_;
};

} // namespace scanloom::sessions
