#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace scanloom::robot {

/// Decompresses the block at which LZ4 data is truncated, as far as it goes. The library decompresses whole blocks
/// only, of up to 4 MiB, which is a whole chunk of most bags.
///
/// Source: LZ4 Frame Format Description 1.6.1, LZ4 Block Format Description.
/// @param packed    LZ4 frames, which end within a block
/// @param size_max  largest size of `bytes`
/// @param bytes     the decompressed whole blocks, to which the rest is appended; not changed if `packed` is damaged
void append_truncated_lz4_block(std::string_view packed, std::size_t size_max, std::string& bytes);

} // namespace scanloom::robot
