#pragma once

#include "server/mapping/snapshot.hpp"

namespace scanloom::mapping {

/// Maps of more chunks have no main bounds: looking for them would take longer than a few milliseconds.
inline constexpr std::size_t kMainBoundsChunksMax = 65'536;

/// Where most of a map is, for who wants to look at it: the box of the largest explored area (chunks that touch or have
/// one between them) and of those around the robots' newest places. What one scan with a wrong pose left far away
/// does not count.
/// @return empty: nothing is explored, or there are more than kMainBoundsChunksMax chunks
[[nodiscard]] grid::CellBox main_bounds_of(const Snapshot& snapshot);

} // namespace scanloom::mapping
