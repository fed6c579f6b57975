#pragma once

#include "core/mapping/snapshot.hpp"
#include "server/tiles/map_image.hpp"

#include <string>

namespace scanloom::foxglove {

/// Returns a part of the occupancy as Message::kGrid: cells are 0 free, 100 occupied, -1 unknown, as in map.pgm.
/// @param maps   the maps
/// @param frame  the cells; see tiles::map_frame()
/// @param stamp  seconds, for readers
/// Cost: proportional to the number of cells.
[[nodiscard]] std::string grid_message(const mapping::Snapshot& maps, const tiles::MapFrame& frame, double stamp);

} // namespace scanloom::foxglove
