#include "server/tiles/tile_version.hpp"

#include <fmt/format.h>

namespace scanloom::tiles {
namespace {

/// Rises when the same cells give other bytes, so that no cache keeps an older program's picture.
constexpr int kRendering = 1;

} // namespace

Revision tile_revision(const mapping::Snapshot& snapshot, TileKey key) {
    return snapshot.occupancy.newest(mapping::chunks_of(cells_of(key)));
}

std::string etag_of(std::string_view session_id, std::string_view layer, TileKey key, Revision tile_revision) {
    return fmt::format("\"{}-{}-{}-{}-{}-{}-{}\"", kRendering, session_id, layer, key.zoom, key.x, key.y,
                       tile_revision);
}

} // namespace scanloom::tiles
