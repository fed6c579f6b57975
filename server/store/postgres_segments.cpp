#include "server/store/postgres_segments.hpp"

#include "common/hash/crc32c.hpp"
#include "server/store/record.hpp"

#include <fmt/format.h>

#include <utility>

namespace scanloom::store::postgres {
namespace {

constexpr std::size_t kLengthBytes = 4;

Error damaged(SessionId session, Revision first, Revision last) {
    return {Errc::kDataLoss,
            fmt::format(
                "entries {} to {} of session {} are damaged; restore the database from a backup, or remove the session",
                first, last, session)};
}

void append_length(std::string& to, std::size_t length) {
    for (int shift = 0; shift < 32; shift += 8) to += static_cast<char>(length >> shift);
}

std::size_t length_at(std::string_view bytes, std::size_t at) {
    std::size_t length = 0;
    for (std::size_t n = kLengthBytes; n > 0; --n) length = length << 8 | static_cast<unsigned char>(bytes[at + n - 1]);
    return length;
}

} // namespace

std::vector<Segment> segments_of(SessionId session, Revision first, std::span<const std::string> entries) {
    std::vector<Segment> segments;
    for (const std::string& entry : entries) {
        const bool fits =
            !segments.empty() && segments.back().body.size() + kLengthBytes + entry.size() <= kSegmentBytes;
        if (!fits) segments.push_back({first, first - 1, {}});
        append_length(segments.back().body, entry.size());
        segments.back().body += entry;
        segments.back().last = first++;
    }
    for (Segment& segment : segments) segment.body = sealed(entry_key(session, segment.first), std::move(segment.body));
    return segments;
}

Result<Visit> visit_entries(SessionId session, Revision first, Revision last, std::string_view body, Revision after,
                            const ScanLog::VisitEntry& visit) {
    const auto bytes = unsealed(entry_key(session, first), body);
    if (!bytes) return damaged(session, first, last);
    Revision revision = first;
    for (std::size_t at = 0; at < bytes->size(); ++revision) {
        if (bytes->size() - at < kLengthBytes) return damaged(session, first, last);
        const std::size_t length = length_at(*bytes, at);
        at += kLengthBytes;
        if (length > bytes->size() - at || revision > last) return damaged(session, first, last);
        if (revision > after) {
            const Visited visited = visit(revision, bytes->substr(at, length));
            if (!visited || *visited == Visit::kStop) return visited;
        }
        at += length;
    }
    if (revision != last + 1) return damaged(session, first, last);
    return Visit::kContinue;
}

std::string sealed_part(SessionId session, std::string_view key, std::string_view value) {
    return sealed(part_key(session, key), std::string(value));
}

Result<std::string_view> unsealed_part(SessionId session, std::string_view key, std::string_view sealed) {
    if (const auto value = unsealed(part_key(session, key), sealed)) return *value;
    return Error{
        Errc::kDataLoss,
        fmt::format("a part of the checkpoint of session {} is damaged in the database; restore the database from a "
                    "backup, or remove the session",
                    session)};
}

} // namespace scanloom::store::postgres
