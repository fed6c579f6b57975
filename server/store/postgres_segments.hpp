#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_entry.hpp"
#include "server/store/scan_log.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Entries of a log as rows of a table: several in one row, because a row costs a database more than its bytes do.
namespace scanloom::store::postgres {

/// Bytes of entries in a row, about. Rows up to 8,160 bytes stay in the pages of their table.
inline constexpr std::size_t kSegmentBytes = 7000;

/// Entries first to last of a session.
struct Segment {
    Revision first = 0;
    Revision last = 0;
    std::string body; ///< each entry after its length: 4 bytes, little-endian; at the end 4 bytes of checksum
};

/// Joins entries to segments of about kSegmentBytes; a larger entry has one of its own.
/// @param first  revision of the first entry
[[nodiscard]] std::vector<Segment> segments_of(SessionId session, Revision first, std::span<const std::string> entries);

/// Visits the entries of a segment after a revision.
/// @return kStop if the visitor stopped
/// Errors: those of the visitor; kDataLoss: the segment is damaged.
[[nodiscard]] Result<Visit> visit_entries(SessionId session, Revision first, Revision last, std::string_view body,
                                          Revision after, const ScanLog::VisitEntry& visit);

/// Returns the value of a checkpoint's part with its checksum.
[[nodiscard]] std::string sealed_part(SessionId session, std::string_view key, std::string_view value);

/// Returns the value without its checksum.
/// Errors: kDataLoss: the checksum does not fit.
[[nodiscard]] Result<std::string_view> unsealed_part(SessionId session, std::string_view key, std::string_view sealed);

} // namespace scanloom::store::postgres
