#pragma once

#include "server/mapping/snapshot.hpp"
#include "server/tiles/tile_key.hpp"

#include <cstdint>
#include <string>
#include <string_view>

namespace scanloom::tiles {

/// How snapshots become the bytes of tiles and map files: raise it when the same snapshot gives others, so that no
/// cache keeps what an older program drew.
inline constexpr std::uint32_t kRenderingVersion = 4;

/// The newest change of any of the tile's cells in the layer; 0 when it was never touched. Changes elsewhere leave it
/// as it is.
[[nodiscard]] Revision tile_revision(const mapping::Snapshot& snapshot, mapping::Layer layer, TileKey key);

/// A strong entity tag, quoted: while it stays, so do the tile's bytes.
/// Pre  the tag tells a session from every other one, also from an earlier one of the same name, and from itself as
///      another version of the program weaves or draws it.
[[nodiscard]] std::string etag_of(std::string_view session_tag, std::string_view layer, TileKey key,
                                  Revision tile_revision);

} // namespace scanloom::tiles
