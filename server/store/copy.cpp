#include "server/store/copy.hpp"

#include <cstddef>
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

} // namespace

Result<> copy_log(ScanLog& from, ScanLog& to, const std::function<void(const CopiedSession&)>& on_session) {
    const auto present = to.sessions();
    if (!present) return present.error();
    if (!present->empty()) return Error{Errc::kConflict, "the store to copy to has sessions; name an empty one"};
    const auto sessions = from.sessions();
    if (!sessions) return sessions.error();
    for (const StoredSession& stored : *sessions) {
        if (!stored.record) return stored.record.error();
        if (stored.damage) return *stored.damage;
        const auto created = to.create_session(*stored.record);
        if (!created) return created.error();
        Appender appender(to, *created);
        auto read =
            from.read(stored.id, 0, [&](Revision, std::string_view entry) -> Visited { return appender.add(entry); });
        if (!read) return read;
        if (auto flushed = appender.flush(); !flushed) return flushed;
        const auto parts = copy_checkpoint(from, stored.id, to, *created);
        if (!parts) return parts.error();
        on_session({stored.id, *created, appender.end(), *parts});
    }
    return {};
}

} // namespace scanloom::store
