#pragma once

#include "server/mapping/snapshot.hpp"
#include "server/tiles/tile_key.hpp"

#include <cstdint>
#include <string>
#include <string_view>

namespace scanloom::tiles {

/// Version of the rendering of tiles and map files. Increase it when the same snapshot gives other bytes, so that
/// caches discard what an older program drew.
inline constexpr std::uint32_t kRenderingVersion = 5;

/// Returns the revision of the newest change of any of the tile's cells in the layer; 0 if none ever changed. Changes
/// elsewhere do not affect it.
[[nodiscard]] Revision tile_revision(const mapping::Snapshot& snapshot, mapping::Layer layer, TileKey key);

/// Returns a strong entity tag, quoted: equal tags mean equal bytes.
/// @param session_tag  differs between any two sessions, even if they have the same name one after the other, and
///                     between program versions that map or draw differently
[[nodiscard]] std::string etag_of(std::string_view session_tag, std::string_view layer, TileKey key,
                                  Revision tile_revision);

} // namespace scanloom::tiles
