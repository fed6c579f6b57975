#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_entry.hpp"
#include "server/store/scan_log.hpp"

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

namespace scanloom::store::postgres {

/// A session that this server may write.
struct OwnedSession {
    std::int64_t epoch = 0; ///< what it writes takes effect only if the database has the same
    Revision end = 0;       ///< last entry that is durable

    friend bool operator==(const OwnedSession&, const OwnedSession&) = default;
};

using OwnedSessions = std::map<SessionId, OwnedSession>;

/// What the threads of a log share: the sessions, and whether the log has failed. Threads: any.
class SharedState {
public:
    [[nodiscard]] std::optional<OwnedSession> find(SessionId session) const {
        const std::lock_guard lock(mutex_);
        const auto found = sessions_.find(session);
        return found == sessions_.end() ? std::nullopt : std::optional(found->second);
    }

    void put(SessionId session, const OwnedSession& owned) {
        const std::lock_guard lock(mutex_);
        sessions_[session] = owned;
    }

    void remove(SessionId session) {
        const std::lock_guard lock(mutex_);
        sessions_.erase(session);
    }

    [[nodiscard]] OwnedSessions sessions() const {
        const std::lock_guard lock(mutex_);
        return sessions_;
    }

    /// Goes on after a failure, with these sessions.
    void restart(OwnedSessions sessions) {
        const std::lock_guard lock(mutex_);
        sessions_ = std::move(sessions);
        failure_.reset();
    }

    /// Notes the first failure: until restart(), it is not known what is stored.
    /// @return the first failure
    Error fail(const Error& why) {
        const std::lock_guard lock(mutex_);
        if (!failure_) failure_ = why;
        return *failure_;
    }

    /// Replaces the failure, as another attempt to go on has failed.
    void fail_again(const Error& why) {
        const std::lock_guard lock(mutex_);
        failure_ = why;
    }

    [[nodiscard]] std::optional<Error> failure() const {
        const std::lock_guard lock(mutex_);
        return failure_;
    }

    /// Notes a configuration fault that does not stop the log; nullopt: there is none.
    void warn(std::optional<std::string> what) {
        const std::lock_guard lock(mutex_);
        warning_ = std::move(what);
    }

    [[nodiscard]] std::optional<std::string> warning() const {
        const std::lock_guard lock(mutex_);
        return warning_;
    }

private:
    mutable std::mutex mutex_;
    OwnedSessions sessions_;
    std::optional<Error> failure_;
    std::optional<std::string> warning_;
};

} // namespace scanloom::store::postgres
