#pragma once

#include "server/mapping/occupancy_layer.hpp"

#include <string>

namespace scanloom::mapping {

/// SHA-256 over the cells of a layer, in lower-case hex: equal maps have equal digests, whatever
/// order, batches or checkpoints they were woven through.
///
/// Shapes  hashed are, by rising ChunkKey, the chunks that hold any known cell: ci, cj as int32, then
///         the 4096 cells as int16, bottom row first; all little-endian.
/// Cost    every cell of the map, once.
[[nodiscard]] std::string digest_of(const OccupancyView& view);

} // namespace scanloom::mapping
