#pragma once

#include "common/error/error.hpp"
#include "core/mapping/snapshot.hpp"
#include "server/store/scan_log.hpp"

#include <cstddef>
#include <memory>
#include <optional>

namespace scanloom::sessions {

/// Facts about a session that is not in memory.
struct Summary {
    std::shared_ptr<const mapping::Snapshot> facts; ///< without cells, classes and trajectories
    std::size_t pages = 0;                          ///< Projection::page_count() of the complete maps
};

/// Returns the summary of a session whose maps are in memory.
[[nodiscard]] Summary summary_of(const mapping::Snapshot& snapshot);

/// Reads the summary of a stored session from its checkpoint.
/// @return nullopt if the log would have to be replayed: no checkpoint of this program's version ends at the log's end
/// Errors: kStoreFailed if the store cannot be read.
/// Threads: any thread that may wait for the disk.
[[nodiscard]] Result<std::optional<Summary>> read_summary(store::ScanLog& log, store::SessionId session,
                                                          const mapping::MapConfig& config);

/// Reads the summary of a stored session as of its checkpoint, after which the log may go on.
/// @return nullopt if there is no checkpoint of this program's version
/// Errors: kStoreFailed if the store cannot be read.
/// Threads: any thread that may wait for the disk.
[[nodiscard]] Result<std::optional<Summary>> read_checkpointed_summary(store::ScanLog& log, store::SessionId session,
                                                                       const mapping::MapConfig& config);

} // namespace scanloom::sessions
