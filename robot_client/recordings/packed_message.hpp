#pragma once

#include "robot_client/recordings/decompression.hpp"
#include "robot_client/recordings/recording.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace scanloom::robot {

/// Returns whether a message is compressed by itself, as rosbag2 does with --compression-mode message. Only its
/// metadata.yaml says so, but no message in CDR begins with these bytes.
[[nodiscard]] inline bool is_packed_message(MessageEncoding encoding, std::string_view bytes) {
    return encoding == MessageEncoding::kCdr && bytes.starts_with(kZstdMagic);
}

/// Decompresses such a message to `unpacked`, and sets `bytes` to it.
/// @return nullopt if it was decompressed, else why not
[[nodiscard]] inline std::optional<std::string> unpack_message(std::string_view& bytes, std::string& unpacked) {
    if (auto reason = decompress(Compression::kZstd, bytes, kRecordedBytesMax, unpacked)) return reason;
    bytes = unpacked;
    return std::nullopt;
}

} // namespace scanloom::robot
