#pragma once

#include <array>
#include <cstddef>
#include <string_view>

/// The checksum that a frame may end with (Frame.crc32c): TCP's own lets one damaged packet in 65,536 pass, and what a
/// router or a cable's driver spoils after checking it passes always.
///
/// Shapes  a body with it is the one field of its message, then this field: two bytes of tag, and the CRC-32C of all
///         bytes before the field, little-endian. Programs that do not know the field pass over it.
namespace scanloom::wire {

inline constexpr std::size_t kChecksumBytes = 6;

/// The field that belongs behind a body.
[[nodiscard]] std::array<char, kChecksumBytes> checksum_field(std::string_view body);

enum class Checksum { kAbsent, kRight, kWrong };

/// What a body that came says of itself.
[[nodiscard]] Checksum checksum_of(std::string_view body);

} // namespace scanloom::wire
