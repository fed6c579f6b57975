#pragma once

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

/// What the writers of bags and MCAP files for tests share. They are independent of the readers that they test.
namespace scanloom::testing_support {

/// A message in a written recording.
struct WrittenMessage {
    std::string topic;
    std::int64_t time = 0;
    std::string bytes;
    /// Place of its record in the file; of the chunk if that is compressed.
    std::size_t begin = 0;
    std::size_t end = 0;
};

/// A part of a written recording.
struct WrittenPart {
    std::size_t begin = 0;
    std::size_t end = 0;
    std::string topic; ///< that it describes
};

/// A recording, and where its parts are.
struct WrittenRecording {
    std::string file;
    std::vector<WrittenMessage> messages;
    std::vector<WrittenPart> descriptions; ///< of topics, outside of compressed chunks
};

/// Appends an integer, little-endian.
template <class Integer>
void append_little(std::string& out, Integer value) {
    for (std::size_t i = 0; i < sizeof value; ++i) out += static_cast<char>(value >> (8 * i));
}

/// Appends a text with its length in 4 bytes.
inline void append_counted(std::string& out, std::string_view text) {
    append_little(out, static_cast<std::uint32_t>(text.size()));
    out += text;
}

inline std::string bz2_compressed(std::string_view bytes) {
    std::string packed(bytes.size() + bytes.size() / 50 + 1000, '\0');
    auto size = static_cast<unsigned>(packed.size());
    std::string copy(bytes);
    if (BZ2_bzBuffToBuffCompress(packed.data(), &size, copy.data(), static_cast<unsigned>(copy.size()), 1, 0, 0) != BZ_OK) {
        throw std::runtime_error("bzip2 does not compress");
    }
    packed.resize(size);
    return packed;
}

/// @param has_checksum  whether a checksum of all bytes is stored, as ROS does
inline std::string lz4_compressed(std::string_view bytes, bool has_checksum = true) {
    LZ4F_preferences_t preferences{};
    preferences.frameInfo.blockMode = LZ4F_blockIndependent;
    preferences.frameInfo.blockSizeID = LZ4F_max64KB;
    preferences.frameInfo.contentChecksumFlag = has_checksum ? LZ4F_contentChecksumEnabled : LZ4F_noContentChecksum;
    std::string packed(LZ4F_compressFrameBound(bytes.size(), &preferences), '\0');
    packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), &preferences));
    return packed;
}

inline std::string zstd_compressed(std::string_view bytes) {
    std::string packed(ZSTD_compressBound(bytes.size()), '\0');
    packed.resize(ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 1));
    return packed;
}

/// Compresses as the formats name it; "" and "none" do not.
inline std::string compressed(std::string_view compression, std::string_view bytes) {
    if (compression == "bz2") return bz2_compressed(bytes);
    if (compression == "lz4") return lz4_compressed(bytes);
    if (compression == "zstd") return zstd_compressed(bytes);
    return std::string(bytes);
}

} // namespace scanloom::testing_support
