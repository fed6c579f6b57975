#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::robot {

/// Compression of a chunk or a message.
enum class Compression {
    kBzip2, ///< as the bzip2 program
    kLz4,   ///< LZ4 frame format, also as ROS writes it
    kZstd,
};

/// First bytes of zstd data.
inline constexpr std::string_view kZstdMagic = "\x28\xb5\x2f\xfd";

/// Decompresses as much as possible and never writes more than `size_max` bytes. Memory is used for bytes that were
/// decompressed, not for a size that the data claims to have.
/// @param packed    compressed data; bytes behind its end are ignored
/// @param size_max  largest number of decompressed bytes
/// @param bytes     is replaced by the decompressed bytes; if the data is damaged, by those before the damage. Bytes
///                  whose checksum is wrong are not among them; the checksum of LZ4 and zstd covers all bytes
/// @param taken     if not null, receives the number of bytes of `packed` up to the end of the compressed data
/// @return nullopt if everything was decompressed, else why not: "the bz2 data is damaged"
[[nodiscard]] std::optional<std::string> decompress(Compression compression, std::string_view packed,
                                                    std::size_t size_max, std::string& bytes,
                                                    std::size_t* taken = nullptr);

/// Returns the compression of data by its first bytes; nullopt if it has none of these.
[[nodiscard]] std::optional<Compression> compression_of(std::string_view packed);

} // namespace scanloom::robot
