#pragma once

#include "common/error/error.hpp"
#include "common/limits/memory_budget.hpp"
#include "common/scan/log_entry.hpp"
#include "core/mapping/projection.hpp"
#include "server/sessions/session_info.hpp"

#include <cstddef>
#include <vector>

namespace scanloom::sessions {

/// Returns an upper bound of the pages that an imported map needs.
[[nodiscard]] std::size_t pages_of_imported(const mapping::MapConfig& config, const std::vector<MapPatch>& patches);

/// Creates the maps of a session that starts with an imported map.
///
/// @param share  takes the pages of each patch before its integration, so that the memory for maps is never exceeded;
///               keeps the pages of the result
/// Errors: kInvalidField if the map has no cells or a patch is too large; kFull if the map exceeds the limits of a
/// session, of the creator, or of the memory for maps; kOverloaded if it exceeds the memory for maps that is free now.
[[nodiscard]] Result<mapping::Projection> integrate_imported(const mapping::MapConfig& config,
                                                             const std::vector<MapPatch>& patches,
                                                             const Creator& creator, limits::MemoryShare& share);

} // namespace scanloom::sessions
