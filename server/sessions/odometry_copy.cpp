#include "server/sessions/odometry_copy.hpp"

#include "common/wire/log_codec.hpp"
#include "server/log/context.hpp"
#include "server/sessions/log_writer.hpp"
#include "server/sessions/recovery.hpp"
#include "server/store/shared_sessions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

namespace scanloom::sessions {
namespace {

/// Makes the pose of a scan, or what a robot says about its poses, that of odometry.
void make_odometry(LogEntry& entry) {
    if (auto* joined = std::get_if<RobotJoined>(&entry); joined != nullptr && joined->poses == Poses::kMap) {
        joined->poses = Poses::kOdometry;
    }
    if (auto* taken = std::get_if<ScanTaken>(&entry); taken != nullptr && taken->scan.pose) {
        taken->scan.odometry = std::exchange(taken->scan.pose, std::nullopt);
    }
}

Result<wire::SessionRecord> record_of(store::ScanLog& log, store::SessionId session) {
    const auto stored = log.sessions();
    if (!stored) return stored.error();
    const auto found = std::ranges::find(*stored, session, &store::StoredSession::id);
    if (found == stored->end()) return Error{Errc::kNotFound, fmt::format("there is no session {}", session)};
    if (!found->record) return found->record.error();
    return wire::decode_session(*found->record);
}

Result<> copy_entries(store::ScanLog& log, store::SessionId from, store::SessionId to, const std::atomic<bool>& stop) {
    LogWriter copy(log, to);
    const auto add = [&](Revision revision, std::string_view bytes) -> Result<> {
        if (stop) return Error{Errc::kShuttingDown, "the server is shutting down; try again when it is back"};
        auto entry = wire::decode_entry(bytes);
        if (!entry) return damaged_entry(revision, entry.error());
        make_odometry(*entry);
        return copy.add(*entry);
    };
    auto read = log.read(from, 0, add);
    return read ? copy.write() : read;
}

/// Returns the session that one is a copy of and replaces; 0: none.
store::SessionId replaced_by(const store::StoredSession& session) {
    if (!session.record) return 0;
    const auto record = wire::decode_session(*session.record);
    return record ? record->replaces : 0;
}

/// Returns the revision of the newest entry that can be read; 0: the end of the log is damaged.
Result<Revision> readable_end(store::ScanLog& log, store::SessionId session) {
    auto end = log.end_of(session);
    if (!end && end.error().code == Errc::kDataLoss) return Revision{0};
    return end;
}

/// Returns whether a copy has all entries of its session. If the session has more, its removal failed, and robots went
/// on.
Result<bool> is_whole(store::ScanLog& log, const store::StoredSession& copy, store::SessionId first) {
    const Revision copied = wire::decode_session(*copy.record)->entries_at_creation;
    const auto end = readable_end(log, copy.id);
    if (!end) return end.error();
    const auto first_end = readable_end(log, first);
    if (!first_end) return first_end.error();
    return *end >= copied && *first_end <= copied;
}

} // namespace

Result<store::SessionId> copy_as_odometry(store::ScanLog& log, store::SessionId session,
                                          const std::atomic<bool>& stop) {
    auto record = record_of(log, session);
    if (!record) return record.error();
    const auto end = log.end_of(session);
    if (!end) return end.error();
    if (auto removed = remove_copies(log, session); !removed) return removed.error();
    if (*end > std::numeric_limits<std::uint32_t>::max()) {
        return Error{Errc::kFull, fmt::format("the session has {} log entries, too many to copy", *end)};
    }
    record->replaces = session;
    record->entries_at_creation = static_cast<std::uint32_t>(*end);
    const auto copy = log.create_session(wire::encode_session(*record));
    if (!copy) return copy.error();
    if (auto copied = copy_entries(log, session, *copy, stop); !copied) {
        static_cast<void>(remove_copies(log, session)); // if this fails, the next call or the next start removes it
        return copied.error();
    }
    return *copy;
}

Result<> remove_copies(store::ScanLog& log, store::SessionId session) {
    const auto stored = log.sessions();
    if (!stored) return stored.error();
    for (const auto& copy : *stored) {
        if (replaced_by(copy) != session) continue;
        if (auto owned = store::own(log, copy.id); !owned) return owned;
        if (auto removed = log.remove_session(copy.id); !removed) return removed;
    }
    return {};
}

Result<std::vector<store::StoredSession>> settle_copies(store::ScanLog& log, std::vector<store::StoredSession> stored) {
    const auto find = [&](store::SessionId id) { return std::ranges::find(stored, id, &store::StoredSession::id); };
    for (std::size_t n = 0; n < stored.size();) {
        const auto first = find(replaced_by(stored[n])); // no session has number 0
        if (first == stored.end()) {
            ++n;
            continue;
        }
        const auto whole = is_whole(log, stored[n], first->id);
        if (!whole) return whole.error();
        const auto lost = *whole ? first : stored.begin() + static_cast<std::ptrdiff_t>(n);
        if (auto removed = log.remove_session(lost->id); !removed) return removed.error();
        stored.erase(lost);
        n = 0;
    }
    return stored;
}

std::vector<store::StoredSession> without_copies(std::vector<store::StoredSession> stored) {
    std::set<store::SessionId> ids;
    for (const auto& session : stored) ids.insert(session.id);
    std::erase_if(stored, [&](const store::StoredSession& session) { return ids.contains(replaced_by(session)); });
    return stored;
}

} // namespace scanloom::sessions
