#pragma once

#include "common/error/error.hpp"
#include "server/store/postgres_connection.hpp"

#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>

namespace scanloom::store::postgres {

/// Limits the entries and checkpoints of all sessions together, so that the disk of the database does not fill up.
///
/// Counts what the rows contain, not the size of the files, which PostgreSQL does not shrink when rows are deleted.
/// Threads: any.
class SizeLimit {
public:
    using Clock = std::chrono::steady_clock;

    /// @param bytes_max  nullopt: no limit
    explicit SizeLimit(std::optional<std::uint64_t> bytes_max) : bytes_max_(bytes_max) {}

    /// Checks that something can be stored. Asks the database for the size from time to time, because other servers
    /// store and remove sessions, too.
    /// Errors: kOverloaded: the limit is reached; kStoreFailed.
    [[nodiscard]] Result<> check(Connection& connection);

    /// Counts what this server has stored since the database was asked.
    void add(std::uint64_t bytes);

private:
    const std::optional<std::uint64_t> bytes_max_;
    std::mutex mutex_; // guards the members below
    std::uint64_t bytes_ = 0;
    std::optional<Clock::time_point> asked_;
};

} // namespace scanloom::store::postgres
