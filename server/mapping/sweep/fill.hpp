#pragma once

#include "server/mapping/laser_chunk.hpp"
#include "server/mapping/sweep/crossings.hpp"

#include <cstddef>

namespace scanloom::mapping::simd {

/// One chunk's bits in each plane, and what they inherit.
struct ChunkWords {
    Planes flipped; ///< 64 words
    Planes carry;   ///< a word a row, all ones where the chunk to the left ended inside; 0 before the first
};

/// Turns flipped bits into cells. Clears them, and carries on.
/// Of 2 contours: the cells within both are free, those between them occupied. Of 4 so those of the inner two, and in
/// `wide` those of the outermost and the innermost.
void fill_bands(const ChunkWords& words, std::size_t contours, ChunkVerdicts& narrow, ChunkVerdicts* wide);

} // namespace scanloom::mapping::simd
