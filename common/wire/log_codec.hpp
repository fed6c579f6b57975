#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_entry.hpp"
#include "common/scan/session_options.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

/// The store's bytes (proto/scanloom/v1/log.proto) as plain values.
namespace scanloom::wire {

/// A session as the store lists it.
struct SessionRecord {
    std::string name;
    double created = 0.0;          ///< seconds since the epoch
    SessionOptions options;        ///< fully resolved when the session was created
    std::uint32_t map_patches = 0; ///< entries that an import begins its log with
    std::string created_by;        ///< name of the token it was made with; empty: there was none
    std::uint64_t chunks_max = 0;  ///< that its maps may have; 0: as many as any may

    friend bool operator==(const SessionRecord&, const SessionRecord&) = default;
};

/// A scan's ranges are packed (packed_ranges.hpp).
[[nodiscard]] std::string encode_entry(const LogEntry& entry);
[[nodiscard]] std::string encode_session(const SessionRecord& record);

/// Errors  kMalformed, kInvalidField: the entry was not written by this program or is damaged.
[[nodiscard]] Result<LogEntry> decode_entry(std::string_view bytes);
[[nodiscard]] Result<SessionRecord> decode_session(std::string_view bytes);

/// When and where a scan was taken, several times as fast as decode_entry(): its ranges are not read. Nothing for an
/// entry of another kind.
/// Errors  as of decode_entry().
[[nodiscard]] Result<std::optional<ScanPose>> decode_scan_pose(std::string_view bytes);

/// The same entry as whoever knows nothing but the messages reads it: with the ranges in the scan, as they also were
/// before format 2 of the store.
/// Errors  kMalformed, as of decode_entry().
[[nodiscard]] Result<std::string> plain_entry(std::string_view bytes);

} // namespace scanloom::wire
