#pragma once

#include "server/store/postgres_connection.hpp"
#include "server/store/postgres_owned_sessions.hpp"
#include "server/store/postgres_size_limit.hpp"
#include "server/store/postgres_write_access.hpp"
#include "server/store/scan_log.hpp"

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace scanloom::store::postgres {

/// Appends entries of many sessions over one connection, all that wait in one statement. A session always uses the same
/// queue, so its entries are stored in their order.
/// Threads: any.
class AppendQueue {
public:
    /// Bytes of entries in a statement, about.
    static constexpr std::uint64_t kStatementBytes = std::uint64_t{4} << 20;

    /// @param access, shared, size_limit  must outlive the queue
    AppendQueue(const WriteAccess& access, SharedState& shared, SizeLimit& size_limit);

    /// Appends what is queued, then stops.
    ~AppendQueue();

    AppendQueue(const AppendQueue&) = delete;
    AppendQueue& operator=(const AppendQueue&) = delete;

    /// As ScanLog::append(). Without entries, `done` is called after all that was queued before.
    void append(SessionId session, Revision first, std::vector<std::string> entries, ScanLog::Done done);

    /// Waits until no statement runs, and holds the next one back while the lock exists. The queue connects again
    /// afterwards.
    [[nodiscard]] std::unique_lock<std::mutex> pause();

    /// Returns appends, entries, synced_writes, queued_bytes and no_room; the others stay unset.
    [[nodiscard]] StoreStats stats() const;

private:
    struct Append {
        SessionId session;
        Revision first;
        std::vector<std::string> entries;
        ScanLog::Done done;
        std::uint64_t bytes;
    };
    struct Group;

    void run();
    [[nodiscard]] std::vector<Append> next();
    void store(std::vector<Append> appends);
    [[nodiscard]] Result<> write(Group& group);

    const WriteAccess& access_;
    SharedState& shared_;
    SizeLimit& size_limit_;
    std::mutex running_; // held while a statement runs; guards connection_
    std::optional<Connection> connection_;
    mutable std::mutex mutex_; // guards the members below
    std::condition_variable waiting_;
    std::deque<Append> queue_;
    bool stopping_ = false;
    StoreStats stats_;
    std::thread thread_; // last: starts after everything that it uses
};

} // namespace scanloom::store::postgres
