#pragma once

#include "server/store/scan_log.hpp"

#include <atomic>
#include <map>
#include <mutex>
#include <optional>

namespace scanloom::store {

/// A scan log in memory that fails and waits on request.
///
/// Keeps ScanLog's contract with two exceptions: no data outlives the object, and `done` is called within append() or
/// release_completions(), so that tests need no thread and no waiting.
/// Thread  any, at the same time. `done` and visitors run without the lock and may call back.
class MemoryScanLog : public ScanLog {
public:
    ~MemoryScanLog() override;

    /// Lets the next change and all later changes fail with this error, like a failed disk.
    void fail_from_next_change(Error error);

    /// Accepts the next `stored` appends, then refuses `count` appends, like a full disk.
    void refuse_appends(std::size_t count, std::size_t stored = 0);

    /// Lets reads fail with this error from now on; nullopt: reads succeed again.
    void fail_reading(std::optional<Error> error);

    /// Lets appends wait, neither durable nor failed, until release_completions().
    void hold_completions();
    void release_completions();
    [[nodiscard]] std::size_t held_completions() const;

    [[nodiscard]] Result<SessionId> create_session(std::string_view record) override;
    [[nodiscard]] Result<std::vector<StoredSession>> sessions() override;
    [[nodiscard]] Result<Revision> end_of(SessionId session) override;
    [[nodiscard]] Result<> remove_session(SessionId session) override;
    void append(SessionId session, Revision first, std::vector<std::string> entries, Done done) override;
    [[nodiscard]] Result<> read(SessionId session, Revision after, const VisitEntry& visit) override;
    [[nodiscard]] Result<> clear_checkpoint(SessionId session) override;
    [[nodiscard]] Result<> write_checkpoint(SessionId session, std::vector<CheckpointPart> parts) override;
    [[nodiscard]] Result<> read_checkpoint(SessionId session, const VisitPart& visit) override;

    /// Lets changes succeed again.
    bool reopen() override;
    [[nodiscard]] StoreStats stats() const override;
    [[nodiscard]] std::uint64_t bytes_on_disk() const override {
        ++looks_at_the_disk_;
        return 0;
    }

    /// Returns how often the disk's free space would have been queried.
    [[nodiscard]] int looks_at_the_disk() const { return looks_at_the_disk_; }

private:
    struct Session {
        std::string record;
        std::vector<std::string> entries;
        std::map<std::string, std::string> parts;
    };
    struct Append {
        SessionId session;
        Revision first;
        std::vector<std::string> entries;
        Done done;
    };

    [[nodiscard]] Result<> store(Append& append);
    [[nodiscard]] Result<Session> copy_of(SessionId session) const;
    void complete(std::vector<Append> appends);

    mutable std::mutex mutex_; // guards the members below
    std::map<SessionId, Session> sessions_;
    SessionId next_session_ = 1;
    std::optional<Error> failed_;
    std::optional<Error> unreadable_;
    std::size_t stored_before_refusing_ = 0;
    std::size_t refused_ = 0; // appends still to be refused
    bool holding_ = false;
    std::vector<Append> held_;
    StoreStats stats_;
    mutable std::atomic<int> looks_at_the_disk_ = 0;
};

} // namespace scanloom::store
