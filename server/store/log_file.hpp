#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// RocksDB's log file format, as far as needed to distinguish a torn end from damage. Write-ahead logs and manifests
/// use it.
namespace scanloom::store {

/// Result of check_log_file().
struct LogFileCheck {
    std::size_t whole_bytes = 0;       ///< up to the end of the last complete write
    std::optional<std::size_t> damage; ///< offset of a record that was complete once and no longer is
};

/// Checks a log file in which each write was synced before the next one began.
///
/// Only the last write can be torn: it ends early, or some of its pages never reached the disk and read as zeros. Any
/// other mismatch with a checksum is damage, and so is every mismatch that is followed by an intact write. RocksDB's
/// own recovery modes do not distinguish these: they refuse a last write with holes, or silently drop complete writes
/// after a damaged length.
///
/// Shapes: blocks of 32 KiB; a record is crc32c:u32 (masked) length:u16 type:u8 payload, little-endian, and does not
///         cross blocks; a write is a kFull record or kFirst, kMiddle..., kLast.
/// Source: RocksDB 7.8, db/log_format.h; its wiki, "Write Ahead Log File Format".
[[nodiscard]] LogFileCheck check_log_file(std::string_view bytes);

/// Returns every complete write of a log file, including those after damage. A write with any damage is omitted.
///
/// RocksDB's own reader cannot be used for this: behind a record with a wrong checksum or length it drops the rest of
/// the block of 32 KiB, and behind a block that the disk cannot read the rest of the file.
[[nodiscard]] std::vector<std::string> whole_writes_of(std::string_view bytes);

} // namespace scanloom::store
