#include "robot_client/recordings/lz4_tail.hpp"

#include <boost/endian/conversion.hpp>

#include <algorithm>
#include <cstdint>
#include <optional>

namespace scanloom::robot {
namespace {

constexpr std::size_t kLz4SizeBytes = 4;
constexpr std::uint32_t kLz4Magic = 0x184D2204;
constexpr std::uint32_t kIsStored = 0x8000'0000; // in the size of a block that is not compressed

std::uint32_t lz4_u32(std::string_view bytes) {
    return boost::endian::load_little_u32(reinterpret_cast<const unsigned char*>(bytes.data()));
}

/// Removes `count` bytes. @return false if there are fewer; then all are removed
bool skip_bytes(std::string_view& bytes, std::size_t count) {
    const bool has_all = count <= bytes.size();
    bytes.remove_prefix(std::min(count, bytes.size()));
    return has_all;
}

/// The block at which frames end.
struct Lz4Block {
    std::string_view bytes;
    bool is_stored = false;
};

/// @return nullopt if the frames end elsewhere
std::optional<Lz4Block> truncated_block(std::string_view packed) {
    constexpr std::size_t kMagicAndFlags = 5;
    while (packed.size() > kMagicAndFlags && lz4_u32(packed) == kLz4Magic) {
        const auto flags = static_cast<unsigned char>(packed[4]);
        const auto has = [flags](unsigned bit) { return (flags >> bit & 1U) != 0; };
        const std::size_t block_checksum = has(4) ? 4 : 0;
        const std::size_t content_size = has(3) ? 8 : 0;
        const std::size_t dictionary = has(0) ? 4 : 0;
        constexpr std::size_t kBlockFlagsAndChecksum = 2;
        if (!skip_bytes(packed, kMagicAndFlags + kBlockFlagsAndChecksum + content_size + dictionary))
            return std::nullopt;
        for (;;) {
            if (packed.size() < kLz4SizeBytes) return std::nullopt;
            const std::uint32_t stated = lz4_u32(packed);
            packed.remove_prefix(kLz4SizeBytes);
            if (stated == 0) break; // the end of the frame
            const std::size_t size = stated & ~kIsStored;
            if (size > packed.size()) return Lz4Block{packed, (stated & kIsStored) != 0};
            if (!skip_bytes(packed, size + block_checksum)) return std::nullopt;
        }
        const std::size_t content_checksum = has(2) ? 4 : 0;
        if (!skip_bytes(packed, content_checksum)) return std::nullopt;
    }
    return std::nullopt;
}

/// Takes the rest of a length whose first four bits are `length`. @return the length, or if it is truncated, a smaller
/// one
std::size_t take_length(std::string_view& block, std::size_t length) {
    bool goes_on = length == 15;
    while (goes_on && !block.empty()) {
        const auto more = static_cast<unsigned char>(block.front());
        block.remove_prefix(1);
        length += more;
        goes_on = more == 255;
    }
    return length;
}

} // namespace

void append_truncated_lz4_block(std::string_view packed, std::size_t size_max, std::string& bytes) {
    const auto found = truncated_block(packed);
    if (!found || bytes.size() >= size_max) return;
    std::string_view block = found->bytes;
    if (found->is_stored) {
        bytes += block.substr(0, size_max - bytes.size());
        return;
    }
    while (!block.empty()) {
        const auto token = static_cast<unsigned char>(block.front());
        block.remove_prefix(1);
        const std::size_t literals = take_length(block, token >> 4U);
        bytes += block.substr(0, std::min(literals, size_max - bytes.size()));
        if (!skip_bytes(block, literals) || block.size() < 2) return;
        const std::size_t offset = boost::endian::load_little_u16(reinterpret_cast<const unsigned char*>(block.data()));
        block.remove_prefix(2);
        constexpr std::size_t kShortestMatch = 4;
        const std::size_t match = kShortestMatch + take_length(block, token & 15U);
        if (offset == 0 || offset > bytes.size()) return;
        const std::size_t count = std::min(match, size_max - bytes.size());
        for (std::size_t i = 0; i < count; ++i) bytes += bytes[bytes.size() - offset]; // they may overlap
        if (bytes.size() == size_max) return;
    }
}

} // namespace scanloom::robot
