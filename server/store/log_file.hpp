#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// RocksDB's log file format, as far as telling a torn end from damage needs it. Its write-ahead logs
/// and manifests are written in it.
namespace scanloom::store {

/// What a log file holds.
struct LogFileCheck {
    std::size_t whole_bytes = 0;       ///< up to the end of the last whole write
    std::optional<std::size_t> damage; ///< offset of a record that was once whole and is no more
};

/// Reads a log file of which each write was synced before the next one began.
///
/// So only the last write can be torn: it ends early, or pages of it never reached the disk and
/// read as zeros. Anything else that does not match its checksum is damage, and so is everything that
/// does not, but has an intact write behind it. RocksDB's own recovery modes do not tell these
/// apart: they refuse a last write with holes, or silently drop whole writes after a damaged length.
///
/// Shapes  blocks of 32 KiB; a record is crc32c:u32 (masked) length:u16 type:u8 payload, little-endian,
///         and does not cross blocks; a write is a kFull record or kFirst, kMiddle..., kLast.
/// Source  RocksDB 7.8, db/log_format.h; its wiki, "Write Ahead Log File Format".
[[nodiscard]] LogFileCheck check_log_file(std::string_view bytes);

/// Every write of a log file that is whole, also those behind damage: of a write that has any, nothing is kept.
[[nodiscard]] std::vector<std::string> whole_writes_of(std::string_view bytes);

} // namespace scanloom::store
