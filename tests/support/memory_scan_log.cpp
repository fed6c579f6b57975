#include "tests/support/memory_scan_log.hpp"

#include <fmt/format.h>

#include <utility>

namespace scanloom::store {
namespace {

Error no_such_session(SessionId session) {
    return {Errc::kNotFound, fmt::format("the store has no session {}; it may have been removed", session)};
}

} // namespace

MemoryScanLog::~MemoryScanLog() { release_completions(); }

void MemoryScanLog::fail_from_next_change(Error error) {
    const std::lock_guard lock(mutex_);
    stats_.last_error = error.message;
    failed_ = std::move(error);
}

void MemoryScanLog::fail_reading(std::optional<Error> error) {
    const std::lock_guard lock(mutex_);
    unreadable_ = std::move(error);
}

void MemoryScanLog::refuse_appends(std::size_t count, std::size_t stored) {
    const std::lock_guard lock(mutex_);
    refused_ = count;
    stored_before_refusing_ = stored;
}

bool MemoryScanLog::reopen() {
    const std::lock_guard lock(mutex_);
    stats_.last_error.reset();
    return std::exchange(failed_, std::nullopt).has_value();
}

void MemoryScanLog::hold_completions() {
    const std::lock_guard lock(mutex_);
    holding_ = true;
}

void MemoryScanLog::release_completions() {
    std::vector<Append> released;
    {
        const std::lock_guard lock(mutex_);
        holding_ = false;
        released.swap(held_);
        stats_.queued_bytes = 0;
    }
    complete(std::move(released));
}

std::size_t MemoryScanLog::held_completions() const {
    const std::lock_guard lock(mutex_);
    return held_.size();
}

Result<SessionId> MemoryScanLog::create_session(std::string_view record) {
    const std::lock_guard lock(mutex_);
    if (failed_) return *failed_;
    sessions_[next_session_].record = record;
    return next_session_++;
}

Result<std::vector<StoredSession>> MemoryScanLog::sessions() {
    const std::lock_guard lock(mutex_);
    std::vector<StoredSession> found;
    for (const auto& [id, session] : sessions_) found.push_back({id, session.record});
    return found;
}

Result<Revision> MemoryScanLog::end_of(SessionId session) {
    const std::lock_guard lock(mutex_);
    const auto found = sessions_.find(session);
    if (found == sessions_.end()) return no_such_session(session);
    return found->second.entries.size();
}

Result<> MemoryScanLog::remove_session(SessionId session) {
    const std::lock_guard lock(mutex_);
    if (failed_) return *failed_;
    if (sessions_.erase(session) == 0) return no_such_session(session);
    return {};
}

void MemoryScanLog::append(SessionId session, Revision first, std::vector<std::string> entries, Done done) {
    std::vector<Append> appends;
    appends.push_back({session, first, std::move(entries), std::move(done)});
    {
        const std::lock_guard lock(mutex_);
        if (holding_) {
            for (const auto& entry : appends.front().entries) stats_.queued_bytes += entry.size();
            held_.push_back(std::move(appends.front()));
            return;
        }
    }
    complete(std::move(appends));
}

void MemoryScanLog::complete(std::vector<Append> appends) {
    for (auto& append : appends) append.done(store(append));
}

Result<> MemoryScanLog::store(Append& append) {
    const std::lock_guard lock(mutex_);
    if (failed_) return *failed_;
    if (stored_before_refusing_ > 0) {
        --stored_before_refusing_;
    } else if (refused_ > 0) {
        --refused_;
        return Error{Errc::kOverloaded, "the disk has no room"};
    }
    const auto session = sessions_.find(append.session);
    if (session == sessions_.end()) return no_such_session(append.session);
    auto& entries = session->second.entries;
    if (append.first != entries.size() + 1) {
        return Error{Errc::kConflict,
                     fmt::format("an append to session {} begins with revision {}, but its log ends with {}",
                                 append.session, append.first, entries.size())};
    }
    ++stats_.appends;
    stats_.entries += append.entries.size();
    ++stats_.synced_writes;
    for (auto& entry : append.entries) entries.push_back(std::move(entry));
    return {};
}

/// Gives visitors a copy, as they may call back and another thread may append at the same time.
Result<MemoryScanLog::Session> MemoryScanLog::copy_of(SessionId session) const {
    const std::lock_guard lock(mutex_);
    const auto found = sessions_.find(session);
    if (found == sessions_.end()) return no_such_session(session);
    if (unreadable_) return *unreadable_;
    return found->second;
}

Result<> MemoryScanLog::read(SessionId session, Revision after, const VisitEntry& visit) {
    const auto copy = copy_of(session);
    if (!copy) return copy.error();
    if (copy->entries.size() < after) {
        return Error{Errc::kDataLoss, fmt::format("the log of session {} ends before revision {}", session, after)};
    }
    for (Revision revision = after + 1; revision <= copy->entries.size(); ++revision) {
        const auto visited = visit(revision, copy->entries[revision - 1]);
        if (!visited) return visited.error();
        if (*visited == Visit::kStop) break;
    }
    return {};
}

Result<> MemoryScanLog::clear_checkpoint(SessionId session) {
    const std::lock_guard lock(mutex_);
    if (failed_) return *failed_;
    const auto found = sessions_.find(session);
    if (found == sessions_.end()) return no_such_session(session);
    found->second.parts.clear();
    return {};
}

Result<> MemoryScanLog::write_checkpoint(SessionId session, std::vector<CheckpointPart> parts) {
    const std::lock_guard lock(mutex_);
    if (failed_) return *failed_;
    const auto found = sessions_.find(session);
    if (found == sessions_.end()) return no_such_session(session);
    for (auto& part : parts) found->second.parts[part.key] = std::move(part.value);
    return {};
}

Result<> MemoryScanLog::read_checkpoint(SessionId session, const VisitPart& visit) {
    const auto copy = copy_of(session);
    if (!copy) return copy.error();
    for (const auto& [key, value] : copy->parts) {
        if (auto visited = visit(key, value); !visited) return visited;
    }
    return {};
}

StoreStats MemoryScanLog::stats() const {
    const std::lock_guard lock(mutex_);
    return stats_;
}

} // namespace scanloom::store
