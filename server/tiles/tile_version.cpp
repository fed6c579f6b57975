#include "server/tiles/tile_version.hpp"

#include "server/mapping/layer_cells.hpp"

#include <fmt/format.h>

namespace scanloom::tiles {

Revision tile_revision(const mapping::Snapshot& snapshot, mapping::Layer layer, TileKey key) {
    return mapping::with_layer(snapshot, layer,
                               [&](const auto& view, auto&&) { return view.newest(grid::chunks_of(cells_of(key))); });
}

std::string etag_of(std::string_view session_tag, std::string_view layer, TileKey key, Revision tile_revision) {
    return fmt::format("\"{}-{}-{}-{}-{}-{}\"", session_tag, layer, key.zoom, key.x, key.y, tile_revision);
}

} // namespace scanloom::tiles
