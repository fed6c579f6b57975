#pragma once

#include "common/error/error.hpp"
#include "server/mapping/snapshot.hpp"
#include "server/store/scan_log.hpp"

#include <cstddef>
#include <memory>
#include <optional>

namespace scanloom::session {

/// What can be told of a session without its maps.
struct Summary {
    std::shared_ptr<const mapping::Snapshot> facts; ///< without cells, classes and trajectories
    std::size_t pages = 0;                          ///< Projection::page_count() of the whole
};

/// Of a session whose maps are there.
[[nodiscard]] Summary summary_of(const mapping::Snapshot& snapshot);

/// Of a session as it is stored.
/// @return nothing where its log has to be woven for that: there is no checkpoint of this version at the log's end.
/// Errors  kStoreFailed: the store cannot be read.
[[nodiscard]] Result<std::optional<Summary>> read_summary(store::ScanLog& log, store::SessionId session,
                                                          const mapping::MapConfig& config);

} // namespace scanloom::session
