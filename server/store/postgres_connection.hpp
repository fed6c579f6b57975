#pragma once

#include "common/error/error.hpp"
#include "server/store/postgres_place.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

struct pg_result;

/// Connections to PostgreSQL, with deadlines of our own for everything that waits.
namespace scanloom::store::postgres {

/// Returns a number as the database has it, signed.
[[nodiscard]] constexpr std::int64_t signed_of(std::uint64_t number) { return static_cast<std::int64_t>(number); }

/// The parameters of a statement, $1 and so on, in PostgreSQL's binary format.
class Parameters {
public:
    void add(std::int64_t number);
    void add(std::string_view bytes);
    void add(std::span<const std::int64_t> numbers);
    void add(std::span<const std::string_view> byte_strings);

    [[nodiscard]] std::size_t size() const noexcept { return values_.size(); }
    [[nodiscard]] const std::vector<std::string>& values() const noexcept { return values_; }
    [[nodiscard]] const std::vector<unsigned>& types() const noexcept { return types_; }

private:
    std::vector<std::string> values_;
    std::vector<unsigned> types_; // object ids of pg_type
};

/// What a statement returned.
class Rows {
public:
    explicit Rows(pg_result* result = nullptr) : result_(result) {}

    [[nodiscard]] int size() const;
    /// @return a bigint
    [[nodiscard]] std::int64_t number(int row, int column) const;
    /// @return the bytes of a bytea or a text; valid as long as the rows
    [[nodiscard]] std::string_view bytes(int row, int column) const;

private:
    struct Clear {
        void operator()(pg_result* result) const;
    };
    std::unique_ptr<pg_result, Clear> result_;
};

/// A connection to the primary of a database, which commits only what its synchronous standbys have on their disks.
/// After an error of run() other than kOverloaded it cannot be used any more, and what happened is not known.
/// Threads: one at a time.
class Connection {
public:
    /// Time until a host has to have answered. libpq's connect_timeout does not bound connections with several hosts.
    static constexpr std::chrono::milliseconds kConnectTimeout{1500};
    /// Time until a statement has to be done, for those that write: longer than a standby or a failover needs.
    static constexpr std::chrono::milliseconds kWriteTimeout{4000};
    /// For a page of rows. Reopening the log waits for readers.
    static constexpr std::chrono::milliseconds kReadTimeout{10'000};
    /// For statements about many rows.
    static constexpr std::chrono::milliseconds kLongTimeout{60'000};

    /// Connects to the host that accepts writes; tries them in random order.
    /// Errors: kStoreFailed: none can be used; the message has the reason of each. kUnsupportedVersion: older than
    ///         PostgreSQL 15.
    [[nodiscard]] static Result<Connection> open(const Place& place);

    Connection(Connection&& other) noexcept;
    Connection& operator=(Connection&& other) noexcept;
    ~Connection();

    /// Runs one statement; without BEGIN, it is durable when this returns.
    /// @param sql  one statement
    /// Errors: kOverloaded: the disk of the database is full, and nothing was stored; kConflict: a lock was not free
    ///         within lock_timeout; kStoreFailed: the statement failed, took too long, or was committed without the
    ///         consent of a standby.
    [[nodiscard]] Result<Rows> run(const char* sql, const Parameters& parameters = {},
                                   std::chrono::milliseconds timeout = kWriteTimeout);

    /// Runs a statement that is run often: the database parses it once for each connection.
    /// @param sql         one statement, which exists as long as the connection
    /// @param parameters  of the same types each time
    /// Errors: those of run().
    [[nodiscard]] Result<Rows> run_prepared(const char* sql, const Parameters& parameters);

    /// Returns whether the connection still exists, as far as this machine knows.
    [[nodiscard]] bool is_alive();

    /// Returns whether it works and is in no transaction, as far as is known.
    [[nodiscard]] bool is_idle() const;

    /// Finds out whether what is committed is durable on more than one machine, as far as the database's settings tell.
    /// @return a sentence that names the setting that prevents it; nullopt: none
    [[nodiscard]] Result<std::optional<std::string>> replication_fault();

private:
    struct State;
    explicit Connection(std::unique_ptr<State> state);
    [[nodiscard]] Result<> make_ready();
    [[nodiscard]] Result<Rows> result_within(std::chrono::milliseconds timeout);

    std::unique_ptr<State> state_;
};

} // namespace scanloom::store::postgres
