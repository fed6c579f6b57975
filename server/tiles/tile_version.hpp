#pragma once

#include "server/mapping/snapshot.hpp"
#include "server/tiles/tile_key.hpp"

#include <string>
#include <string_view>

namespace scanloom::tiles {

/// The newest change of any of the tile's cells; 0 when it was never touched. Changes elsewhere leave it as it is.
[[nodiscard]] Revision tile_revision(const mapping::Snapshot& snapshot, TileKey key);

/// A strong entity tag, quoted: while it stays, so do the tile's bytes.
/// Pre  the id tells a session from every other one, also from an earlier one of the same name.
[[nodiscard]] std::string etag_of(std::string_view session_id, std::string_view layer, TileKey key,
                                  Revision tile_revision);

} // namespace scanloom::tiles
