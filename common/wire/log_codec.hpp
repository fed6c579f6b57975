#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_entry.hpp"
#include "common/scan/session_options.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

/// Converts between the bytes in the store (proto/scanloom/v1/log.proto) and plain values.
namespace scanloom::wire {

/// The record of a session in the store.
struct SessionRecord {
    std::string name;
    double created = 0.0;                  ///< seconds since the epoch
    SessionOptions options;                ///< with all defaults filled in when the session was created
    std::uint32_t entries_at_creation = 0; ///< with which its log begins: of an import, and of localize-only mode
    std::string created_by;                ///< name of the token that created it; empty: no token
    std::uint64_t chunks_max = 0;          ///< chunks that its maps may have; 0: as many as any session
    std::uint64_t replaces = 0;            ///< the session that this one is a copy of, and replaces; 0: none

    friend bool operator==(const SessionRecord&, const SessionRecord&) = default;
};

/// Serializes an entry; the ranges of a scan are packed (packed_ranges.hpp).
[[nodiscard]] std::string encode_entry(const LogEntry& entry);
[[nodiscard]] std::string encode_session(const SessionRecord& record);

/// Parses what encode_entry() has written.
/// Errors: kMalformed or kInvalidField if the bytes are damaged or were written by another program.
[[nodiscard]] Result<LogEntry> decode_entry(std::string_view bytes);

/// Parses what encode_session() has written.
/// Errors: kMalformed or kInvalidField if the bytes are damaged or were written by another program.
[[nodiscard]] Result<SessionRecord> decode_session(std::string_view bytes);

/// Parses only when and where a scan was taken. This is several times as fast as decode_entry(), because the ranges are
/// not read.
/// @param bytes  an entry of any kind
/// @return robot, seq, stamp and pose of the scan; nullopt if the entry is not a scan
/// Errors: those of decode_entry().
[[nodiscard]] Result<std::optional<ScanPose>> decode_scan_pose(std::string_view bytes);

/// Converts an entry for readers that know only the messages of log.proto: with the ranges in the scan, where they were
/// before format 2 of the store.
/// Errors: kMalformed if the bytes are damaged or were written by another program.
[[nodiscard]] Result<std::string> plain_entry(std::string_view bytes);

} // namespace scanloom::wire
