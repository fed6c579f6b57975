#pragma once

#include <array>
#include <cstddef>
#include <string_view>

/// The optional checksum at the end of a frame (Frame.crc32c). TCP's checksum accepts one damaged packet in 65,536, and
/// every packet that a router or a network driver damages after having checked it.
///
/// Format: a body with a checksum is the one field of its message, then this field: two bytes of tag and the CRC-32C of
///         all bytes before the field, little-endian. Programs that do not know the field skip it.
namespace scanloom::wire {

inline constexpr std::size_t kChecksumBytes = 6;

/// Returns the checksum field to append to `body`.
[[nodiscard]] std::array<char, kChecksumBytes> checksum_field(std::string_view body);

enum class Checksum { kAbsent, kRight, kWrong };

/// Checks the checksum at the end of a received body.
[[nodiscard]] Checksum checksum_of(std::string_view body);

} // namespace scanloom::wire
