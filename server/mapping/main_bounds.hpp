#pragma once

#include "server/mapping/snapshot.hpp"

namespace scanloom::mapping {

/// The largest map, in chunks, for which main_bounds_of() searches. Larger maps would take more than a few
/// milliseconds.
inline constexpr std::size_t kMainBoundsChunksMax = 65'536;

/// Returns the part of a map to show first: the box of the largest explored area and of the areas around the robots'
/// newest positions. Chunks that touch, or have one chunk between them, belong to the same area. Cells far away that
/// result from a single scan with a wrong pose do not count.
/// @return the box in cells; empty if nothing is explored or the map has more than kMainBoundsChunksMax chunks
[[nodiscard]] grid::CellBox main_bounds_of(const Snapshot& snapshot);

} // namespace scanloom::mapping
