#include "server/store/copy.hpp"

#include "common/wire/log_codec.hpp"

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::store {
namespace {

constexpr std::size_t kEntryBytes = std::size_t{1} << 20; // appended at once, about
constexpr std::size_t kPartBytes = std::size_t{16} << 20;

/// Appends entries in groups.
class Appender {
public:
    Appender(ScanLog& to, SessionId session) : to_(to), session_(session) {}

    Result<> add(std::string_view entry) {
        bytes_ += entry.size();
        entries_.emplace_back(entry);
        return bytes_ < kEntryBytes ? Result<>() : flush();
    }

    Result<> flush() {
        bytes_ = 0;
        const std::size_t count = entries_.size();
        if (count == 0) return {};
        auto appended = append_and_wait(to_, session_, end_ + 1, std::exchange(entries_, {}));
        if (appended) end_ += count;
        return appended;
    }

    [[nodiscard]] Revision end() const { return end_; }

private:
    ScanLog& to_;
    const SessionId session_;
    std::vector<std::string> entries_;
    std::size_t bytes_ = 0;
    Revision end_ = 0;
};

Result<std::uint64_t> copy_checkpoint(ScanLog& from, SessionId source, ScanLog& to, SessionId target) {
    std::vector<CheckpointPart> parts;
    std::size_t bytes = 0;
    std::uint64_t count = 0;
    const auto flush = [&] {
        bytes = 0;
        return parts.empty() ? Result<>() : to.write_checkpoint(target, std::exchange(parts, {}));
    };
    auto read = from.read_checkpoint(source, [&](std::string_view key, std::string_view value) -> Result<> {
        parts.push_back({std::string(key), std::string(value)});
        bytes += value.size();
        ++count;
        return bytes < kPartBytes ? Result<>() : flush();
    });
    if (!read) return read.error();
    if (auto written = flush(); !written) return written.error();
    return count;
}

/// Returns the records of the sessions to be copied, by their ids. Numbers of sessions are others in the new store, so
/// a copy that has replaced a session names it no longer. One that has not replaced it yet is left out: it can be made
/// again.
Result<std::map<SessionId, std::string>> records_to_copy(const std::vector<StoredSession>& sessions) {
    std::map<SessionId, std::string> records;
    for (const StoredSession& stored : sessions) {
        if (!stored.record) return stored.record.error();
        if (stored.damage) return *stored.damage;
        records[stored.id] = *stored.record;
    }
    std::map<SessionId, std::string> kept;
    for (const auto& [id, bytes] : records) {
        auto record = wire::decode_session(bytes);
        if (record && records.contains(record->replaces)) continue;
        const bool has_replaced = record && record->replaces != 0;
        if (has_replaced) record->replaces = record->entries_at_creation = 0;
        kept[id] = has_replaced ? wire::encode_session(*record) : bytes;
    }
    return kept;
}

} // namespace

Result<> copy_log(ScanLog& from, ScanLog& to, const std::function<void(const CopiedSession&)>& on_session) {
    const auto present = to.sessions();
    if (!present) return present.error();
    if (!present->empty()) return Error{Errc::kConflict, "the store to copy to has sessions; name an empty one"};
    const auto sessions = from.sessions();
    if (!sessions) return sessions.error();
    const auto records = records_to_copy(*sessions);
    if (!records) return records.error();
    for (const auto& [id, record] : *records) {
        const auto created = to.create_session(record);
        if (!created) return created.error();
        Appender appender(to, *created);
        auto read = from.read(id, 0, [&](Revision, std::string_view entry) -> Visited { return appender.add(entry); });
        if (!read) return read;
        if (auto flushed = appender.flush(); !flushed) return flushed;
        const auto parts = copy_checkpoint(from, id, to, *created);
        if (!parts) return parts.error();
        on_session({id, *created, appender.end(), *parts});
    }
    return {};
}

} // namespace scanloom::store
