#pragma once

#include "server/mapping/snapshot.hpp"

#include <string>

namespace scanloom::mapping {

/// Returns the SHA-256 digest of a layer's cells and cell size, in lower-case hexadecimal.
///
/// Equal maps have equal digests, whatever order, batches or checkpoints they were made through; different maps have
/// different digests.
///
/// The hash covers the cell size in metres as a float64, then, in increasing order of ChunkKey, each chunk that
/// contains a known cell: ci and cj as int32 and the 4096 cells, bottom row first. All numbers are little-endian. A
/// cell is an int16 in the occupancy and sonar layers (log_odds.hpp) and one byte in the himm layer (himm.hpp) and in
/// the classification (classify/cell_class.hpp).
/// Cost: reads every cell of the layer once.
[[nodiscard]] std::string digest_of(const Snapshot& snapshot, Layer layer);

} // namespace scanloom::mapping
