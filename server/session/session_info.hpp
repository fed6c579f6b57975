#pragma once

#include "common/scan/scan_filter.hpp"
#include "server/mapping/map_config.hpp"
#include "server/session/page_budget.hpp"
#include "server/store/scan_log.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace scanloom::session {

/// What one session may use. A fold weaves whatever the log holds: the bound is kept when scans are accepted.
struct SessionLimits {
    std::size_t chunks_max = kMost;

    static constexpr std::size_t kMost = 131'072; ///< of 64 x 64 cells: 2.5 GiB, 1.3 square kilometres at 5 cm

    std::vector<std::shared_ptr<PageBudget>> shared = {}; ///< with other sessions

    /// Called with the pages that the next scan may need when a budget has no room for it, and it is refused; on the
    /// session's strand: hand over, do not block. May be empty.
    std::function<void(std::size_t)> on_short = {};
};

/// What a session is, for as long as it is in memory; all but its exclusions for as long as it exists.
struct SessionInfo {
    store::SessionId id = 0;
    std::string name;
    double created = 0.0; ///< seconds since the epoch
    mapping::MapConfig config;
    std::string created_by;                        ///< name of the token it was made with; empty: there was none
    std::size_t chunks_max = SessionLimits::kMost; ///< less where that token was to make only small ones
    SharedExclusions exclusions = no_exclusions(); ///< of its log, when it was last read from the store
};

/// Which scans its maps hold.
[[nodiscard]] ScanFilter scan_filter_of(const SessionInfo& info);

/// Tells a session from every other, also from a deleted one of the same name and from one of another
/// store: 16 hexadecimal digits.
[[nodiscard]] std::string tag_of(const SessionInfo& info);

/// What all sessions count together. Of what was submitted, each scan is one of these, or still under way. Thread: any.
struct SessionCounters {
    std::atomic<std::uint64_t> scans_applied = 0;    ///< in the log and in the map
    std::atomic<std::uint64_t> scans_jumped = 0;     ///< in the log, left out of the map for max_jump
    std::atomic<std::uint64_t> scans_duplicates = 0; ///< sent again after a reconnect and dropped
    std::atomic<std::uint64_t> scans_dropped = 0;    ///< refused, or come when their link had ended; not acknowledged
};

} // namespace scanloom::session
