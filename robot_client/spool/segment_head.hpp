#pragma once

#include "common/error/error.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::robot {

/// Which of a file's scans were sent, and under which seqs. It is kept across restarts of the program, so a scan that
/// was sent is sent again under the same seq.
struct SentAs {
    std::uint64_t from = 0; ///< number within the spool; the scans before it are stored
    std::uint64_t seq = 0;  ///< of that scan on the server; the following scans continue it; 0: none was sent

    friend bool operator==(const SentAs&, const SentAs&) = default;
};

/// A spool file begins with `"SCSPOOL2", uint64 from, uint64 seq, uint32 CRC-32 of both` (big-endian), followed by its
/// records. The head is overwritten in place, which needs no room on a full disk.
inline constexpr std::size_t kSegmentHeadBytes = 28;

[[nodiscard]] std::string segment_head(const SentAs& sent);

/// Returns nullopt if the bytes are not a head or are damaged.
[[nodiscard]] std::optional<SentAs> read_segment_head(std::string_view bytes);

/// Returns when the head is on the disk.
/// Errors: kStoreFailed.
[[nodiscard]] Result<> write_segment_head(const std::filesystem::path& file, const SentAs& sent);

} // namespace scanloom::robot
