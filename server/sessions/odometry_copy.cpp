#include "server/sessions/odometry_copy.hpp"

#include "common/wire/log_codec.hpp"
#include "server/log/context.hpp"
#include "server/sessions/log_writer.hpp"
#include "server/sessions/recovery.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
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
    const auto record =
        session.record ? wire::decode_session(*session.record) : Result<wire::SessionRecord>(session.record.error());
    return record ? record->replaces : 0;
}

Result<bool> is_complete(store::ScanLog& log, const store::StoredSession& copy) {
    const auto end = log.end_of(copy.id);
    if (!end && end.error().code == Errc::kDataLoss) return false;
    if (!end) return end.error();
    return *end >= wire::decode_session(*copy.record)->entries_at_creation;
}

} // namespace

Result<store::SessionId> copy_as_odometry(store::ScanLog& log, store::SessionId session,
                                          const std::atomic<bool>& stop) {
    auto record = record_of(log, session);
    if (!record) return record.error();
    const auto end = log.end_of(session);
    if (!end) return end.error();
    record->replaces = session;
    record->entries_at_creation = static_cast<std::uint32_t>(*end);
    const auto copy = log.create_session(wire::encode_session(*record));
    if (!copy) return copy.error();
    if (auto copied = copy_entries(log, session, *copy, stop); !copied) {
        static_cast<void>(log.remove_session(*copy)); // if this fails, the next start removes it
        return copied.error();
    }
    return *copy;
}

Result<std::vector<store::StoredSession>> settle_copies(store::ScanLog& log, std::vector<store::StoredSession> stored) {
    std::vector<store::SessionId> removed;
    for (const auto& copy : stored) {
        const auto first = replaced_by(copy);
        if (first == 0 || std::ranges::find(stored, first, &store::StoredSession::id) == stored.end()) continue;
        const auto complete = is_complete(log, copy);
        if (!complete) return complete.error();
        removed.push_back(*complete ? first : copy.id);
        if (auto done = log.remove_session(removed.back()); !done) return done.error();
    }
    std::erase_if(stored, [&](const auto& session) { return std::ranges::find(removed, session.id) != removed.end(); });
    return stored;
}

} // namespace scanloom::sessions
