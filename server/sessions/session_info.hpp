#pragma once

#include "common/error/error.hpp"
#include "common/limits/memory_budget.hpp"
#include "common/scan/scan_filter.hpp"
#include "core/mapping/map_config.hpp"
#include "server/auth/token.hpp"
#include "server/sessions/loop_counters.hpp"
#include "server/store/scan_log.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace scanloom::sessions {

// Properties of one session

/// Resources that one session may use. They are enforced when scans are accepted; applying an entry of the log does not
/// check them again.
struct SessionLimits {
    std::size_t chunks_max = kMost;

    static constexpr std::size_t kMost = 131'072; ///< chunks of 64 x 64 cells: 2.5 GiB, 1.3 square km at 5 cm

    std::vector<std::shared_ptr<limits::MemoryBudget>> shared = {}; ///< budgets shared with other sessions

    /// Called when a scan is refused because a shared budget has no room, with the number of pages that the scan may
    /// need. Called on the session's strand: must not block. May be empty.
    std::function<void(std::size_t)> on_short = {};
};

/// The fixed properties of a session. They do not change while the session exists, except for the exclusions, which do
/// not change while it is in memory.
struct SessionInfo {
    store::SessionId id = 0;
    std::string name;
    double created = 0.0; ///< seconds since the epoch
    mapping::MapConfig config;
    std::string created_by;                        ///< name of the token that created it; empty: no token
    std::size_t chunks_max = SessionLimits::kMost; ///< lower if that token has a limit
    std::uint32_t entries_at_creation = 0;         ///< a log with fewer entries is of an interrupted creation
    SharedExclusions exclusions = no_exclusions(); ///< in the log when it was last read from the store
};

/// Returns the filter that decides which scans the session's maps contain: its exclusions and its max_jump.
[[nodiscard]] ScanFilter scan_filter_of(const SessionInfo& info);

/// Returns 16 hexadecimal digits that identify a session. A deleted session of the same name, or a session of another
/// store, has another tag.
[[nodiscard]] std::string tag_of(const SessionInfo& info);

// What all sessions share

/// Counters of all sessions together. Every submitted scan is counted in exactly one of those of scans, or is still in
/// progress.
/// Threads: any thread.
struct SessionCounters {
    std::atomic<std::uint64_t> scans_applied = 0;    ///< in the log and in the map
    std::atomic<std::uint64_t> scans_jumped = 0;     ///< in the log, but not in the map because of max_jump
    std::atomic<std::uint64_t> scans_unplaced = 0;   ///< in the log, but not in the map: they fit no place
    std::atomic<std::uint64_t> scans_duplicates = 0; ///< sent again after a reconnect and dropped
    std::atomic<std::uint64_t> scans_dropped = 0;    ///< refused, or received after their link ended; not acknowledged
    std::atomic<std::uint64_t> loops_accepted = 0;   ///< edges to parts of the map that were made earlier
    std::atomic<std::uint64_t> maps_corrected = 0;   ///< times that maps followed corrected poses of earlier scans
    LoopCounters loop_search;                        ///< of all sessions with estimated poses
};

/// Returns the error (kShuttingDown) for requests that arrive while the server shuts down.
[[nodiscard]] Error shutting_down();

/// The creator of a session and the limits of its token.
struct Creator {
    std::string token;                                                  ///< name of the token; empty: no token was used
    std::size_t sessions_max = std::numeric_limits<std::size_t>::max(); ///< existing sessions created with the token
    std::size_t chunks_max = SessionLimits::kMost;                      ///< of each session
};

/// Returns the creator that uses `token`, with the limits of the token.
[[nodiscard]] Creator creator_of(const auth::Token& token);

} // namespace scanloom::sessions
