#pragma once

#include "server/mapping/snapshot.hpp"

#include <string>

namespace scanloom::mapping {

/// SHA-256 over the cells of a layer and their size, in lower-case hex: equal maps have equal digests, whatever order,
/// batches or checkpoints they were woven through, and unlike ones have not.
///
/// Shapes  hashed are the cell size in metres, a float64, and by rising ChunkKey the chunks that hold any known cell:
///         ci, cj as int32, then the 4096 cells, bottom row first; all little-endian. A cell is an int16 of the
///         occupancy and sonar layers (log_odds.hpp), a byte of the himm layer (himm.hpp) and of the classification
///         (classify/cell_class.hpp).
/// Cost    every cell of the layer, once.
[[nodiscard]] std::string digest_of(const Snapshot& snapshot, Layer layer);

} // namespace scanloom::mapping
