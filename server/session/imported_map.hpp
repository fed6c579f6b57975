#pragma once

#include "common/error/error.hpp"
#include "common/scan/map_patch.hpp"
#include "server/mapping/projection.hpp"
#include "server/session/maker.hpp"
#include "server/session/page_share.hpp"

#include <cstddef>
#include <vector>

namespace scanloom::session {

/// The pages that an imported map takes at most.
[[nodiscard]] std::size_t pages_of_imported(const mapping::MapConfig& config, const std::vector<MapPatch>& patches);

/// The maps of a session that begins with an imported map.
/// @param share  takes the pages of each patch before the patch is integrated, so that no more memory is used than maps
/// may
///               have; keeps those of the result
/// Errors  kInvalidField, kFull: the map fits into no session, or into none of this maker. kOverloaded: not into the
///         memory for maps that is free now.
[[nodiscard]] Result<mapping::Projection> integrate_imported(const mapping::MapConfig& config,
                                                             const std::vector<MapPatch>& patches, const Maker& maker,
                                                             PageShare& share);

} // namespace scanloom::session
