#pragma once

#include "core/mapping/laser_chunk.hpp"
#include "core/mapping/sweep/crossings.hpp"

#include <cstddef>

namespace scanloom::mapping::simd {

/// The bits of one chunk in each plane, and the state carried from the chunk to its left.
struct ChunkWords {
    Planes flipped; ///< 64 words
    Planes carry;   ///< one word per row, all ones if the chunk to the left ended inside; 0 for the first chunk
};

/// Converts flipped bits to verdicts. Clears the flipped bits and updates the carry.
/// @param words  bits and carry of each plane
/// @param contours  2 or 4
/// @param narrow  with 2 contours: cells within both are free, cells between them occupied; with 4, the same for the
///                two middle ones
/// @param wide  with 4 contours: the same for the innermost and the outermost; unused with 2
void fill_bands(const ChunkWords& words, std::size_t contours, ChunkVerdicts& narrow, ChunkVerdicts* wide);

} // namespace scanloom::mapping::simd
