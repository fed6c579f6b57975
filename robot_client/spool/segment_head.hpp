#pragma once

#include "common/error/error.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::robot {

/// Which of a file's scans have been sent, and as what. It outlives the program: what was sent once under a seq is sent
/// again under the same.
struct SentAs {
    std::uint64_t from = 0; ///< number within the spool: the scans before it are stored
    std::uint64_t seq = 0;  ///< that the server knows that scan by, those behind it follow; 0: none of them was sent

    friend bool operator==(const SentAs&, const SentAs&) = default;
};

/// A file of the spool begins with `"SCSPOOL2", uint64 from, uint64 seq, uint32 CRC-32 of both` (big-endian); then come
/// its records. That place is written anew where it stands, which needs no room on a full disk.
inline constexpr std::size_t kSegmentHeadBytes = 28;

[[nodiscard]] std::string segment_head(const SentAs& sent);

/// Nothing where the bytes are no such head, or a damaged one.
[[nodiscard]] std::optional<SentAs> read_segment_head(std::string_view bytes);

/// Returns when the disk has it. Errors  kStoreFailed.
[[nodiscard]] Result<> write_segment_head(const std::filesystem::path& file, const SentAs& sent);

} // namespace scanloom::robot
