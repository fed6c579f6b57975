#pragma once

#include "common/error/error.hpp"
#include "server/store/postgres_connection.hpp"
#include "server/store/postgres_owned_sessions.hpp"
#include "server/store/postgres_write_access.hpp"
#include "server/store/shared_sessions.hpp"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

namespace scanloom::store::postgres {

/// A node whose row is older than this, by the database's clock, counts as dead.
inline constexpr std::chrono::seconds kDeadAfter{5};

/// This server's row in the table of nodes, which it renews each second. The row only says that the server lives: what
/// it writes is safe by the epochs of its sessions.
/// Threads: any.
class OwnNode {
public:
    /// @param access, shared  must outlive the node
    OwnNode(const WriteAccess& access, SharedState& shared) : access_(access), shared_(shared) {}

    /// Removes the row, so that others may take the sessions at once.
    ~OwnNode();

    OwnNode(const OwnNode&) = delete;
    OwnNode& operator=(const OwnNode&) = delete;

    /// Enters the server, in place of an earlier one of this name, whose sessions have no owner then. Call once.
    [[nodiscard]] Result<> enter(Connection& connection, std::string name);

    /// Returns the number that no other server has had; 0 before enter().
    [[nodiscard]] std::int64_t id() const noexcept { return id_; }

    /// Returns whether the row was renewed without a gap for as long as others need to be dead. After the database
    /// could not be used for a while, all rows are old, and the other nodes need time to renew theirs.
    [[nodiscard]] bool is_steady() const noexcept {
        const auto now = Clock::now();
        return now - steady_since_.load() >= kDeadAfter && now - renewed_at_.load() <= kDeadAfter / 2;
    }

    /// Renews the row.
    /// Errors: kNotOwner: another server was started with the same name; kStoreFailed.
    [[nodiscard]] Result<> renew(Connection& connection);

    /// Writes the addresses and the version into the row, now and at each renewal.
    [[nodiscard]] Result<> announce(const NodeInfo& info);

private:
    using Clock = std::chrono::steady_clock;

    void keep(const std::stop_token& stop);
    [[nodiscard]] Result<> renew_over(std::optional<Connection>& connection);

    const WriteAccess& access_;
    SharedState& shared_;
    std::string name_;
    std::int64_t id_ = 0;
    std::atomic<Clock::time_point> renewed_at_ = Clock::now();
    std::atomic<Clock::time_point> steady_since_ = Clock::time_point::max();
    mutable std::mutex mutex_; // of waiting_; guards info_
    NodeInfo info_;
    std::condition_variable_any waiting_;
    std::jthread thread_; // last: uses the others
};

} // namespace scanloom::store::postgres
