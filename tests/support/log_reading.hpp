#pragma once

#include "server/store/scan_log.hpp"

#include <future>
#include <map>
#include <string>
#include <utility>
#include <vector>

/// A scan log's calls with plain values as results, for tests that examine its contents.
namespace scanloom::store {

inline Result<std::vector<std::string>> entries_after(ScanLog& log, SessionId session, Revision after) {
    std::vector<std::string> entries;
    auto read = log.read(session, after, [&](Revision, std::string_view entry) -> Result<> {
        entries.emplace_back(entry);
        return {};
    });
    if (!read) return read.error();
    return entries;
}

inline Result<std::map<std::string, std::string>> checkpoint_of(ScanLog& log, SessionId session) {
    std::map<std::string, std::string> parts;
    auto read = log.read_checkpoint(session, [&](std::string_view key, std::string_view value) -> Result<> {
        parts.emplace(key, value);
        return {};
    });
    if (!read) return read.error();
    return parts;
}

/// Returns an entry of up to 3 KB that is unique to this session and revision.
inline std::string distinct_entry(SessionId session, Revision revision) {
    const std::string name = std::to_string(session) + "/" + std::to_string(revision) + ";";
    std::string entry;
    const std::size_t bytes = (session * 7919 + revision * 104729) % 3000;
    do entry += name;
    while (entry.size() < bytes);
    return entry;
}

inline std::vector<std::string> distinct_entries(SessionId session, Revision first, std::size_t count) {
    std::vector<std::string> entries;
    for (std::size_t i = 0; i < count; ++i) entries.push_back(distinct_entry(session, first + i));
    return entries;
}

} // namespace scanloom::store
