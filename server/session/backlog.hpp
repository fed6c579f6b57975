#pragma once

#include "common/scan/log_entry.hpp"
#include "server/mapping/reach.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace scanloom::session {

/// One entry that a robot gave, checked, on its way into the log and the maps.
struct Submitted {
    RobotIndex robot = 0;
    std::optional<LogEntry> entry; ///< nothing: what was sent is known already and only holds credit
    mapping::Reach reach;          ///< of a scan
    std::size_t bytes = 0;         ///< of credit, given back when the entry is in the maps
};

/// Entries that are appended at once and then woven.
struct Group {
    std::vector<Submitted> entries;
    std::int64_t chunks = 0; ///< at most as many chunks of the map will be new
    double work = 0.0;       ///< as Reach::work
};

/// Bounds of a group: of the wait for its ack, and of what a restart has to weave again.
inline constexpr std::size_t kGroupEntriesMax = 256;
inline constexpr double kGroupWorkMax = mapping::kScanWorkMax;

/// Entries that wait for the log. Bounded by the links' credits.
class Backlog {
public:
    void add(Submitted entry) { waiting_.push_back(std::move(entry)); }

    [[nodiscard]] bool empty() const noexcept { return waiting_.empty(); }
    [[nodiscard]] std::size_t size() const noexcept { return waiting_.size(); }
    [[nodiscard]] const Submitted& front() const { return waiting_.front(); }

    /// Takes the next group, of which no more than `room` chunks can be new; empty when already the
    /// first entry could need more.
    [[nodiscard]] Group next_group(std::int64_t room);

    /// Pre: it was the last group taken.
    void put_back(Group group);

    void drop(RobotIndex robot);
    void clear() { waiting_.clear(); }

private:
    std::deque<Submitted> waiting_;
};

} // namespace scanloom::session
