#include "common/wire/frame_checksum.hpp"

#include "common/hash/crc32c.hpp"

#include <boost/endian/conversion.hpp>

#include <cstdint>
#include <cstring>
#include <optional>

namespace scanloom::wire {
namespace {

constexpr std::string_view kTag = "\xfd\x7f"; // field 2047, fixed32
constexpr std::uint8_t kLengthDelimited = 2;

std::optional<std::uint64_t> take_varint(std::string_view& bytes) {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 64 && !bytes.empty(); shift += 7) {
        const auto byte = static_cast<std::uint8_t>(bytes.front());
        bytes.remove_prefix(1);
        value |= std::uint64_t{byte & 0x7fU} << shift;
        if (byte < 0x80) return value;
    }
    return std::nullopt;
}

/// Returns whether these bytes are exactly one field: then what follows is not a part of it that looks like a checksum.
bool is_one_field(std::string_view bytes) {
    const auto tag = take_varint(bytes);
    const auto size = take_varint(bytes);
    return tag && (*tag & 7U) == kLengthDelimited && size && *size == bytes.size();
}

} // namespace

std::array<char, kChecksumBytes> checksum_field(std::string_view body) {
    std::array<char, kChecksumBytes> field{};
    std::memcpy(field.data(), kTag.data(), kTag.size());
    boost::endian::store_little_u32(reinterpret_cast<unsigned char*>(field.data()) + kTag.size(), crc32c(body));
    return field;
}

Checksum checksum_of(std::string_view body) {
    if (body.size() <= kChecksumBytes) return Checksum::kAbsent;
    const auto content = body.substr(0, body.size() - kChecksumBytes);
    const auto field = body.substr(content.size());
    if (!field.starts_with(kTag)) return Checksum::kAbsent;
    const auto right = checksum_field(content);
    if (field == std::string_view(right.data(), right.size())) return Checksum::kRight;
    return is_one_field(content) ? Checksum::kWrong : Checksum::kAbsent;
}

} // namespace scanloom::wire
