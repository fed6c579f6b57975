#pragma once

#include "server/store/postgres_connection.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/temporary_directory.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace scanloom::test {

/// A server of PostgreSQL of its own, with a socket in a temporary directory and without a port. The destructor stops
/// it and removes its files. Run as root, it is started as the user `postgres`, whom Debian's package creates.
/// Errors: throws std::runtime_error if PostgreSQL is not installed or does not start.
class PostgresServer {
public:
    /// Starts a primary. What it has written survives kill(), but no power failure.
    PostgresServer();

    /// Starts a primary whose data survives a power failure.
    /// @param data  directory to create for it
    explicit PostgresServer(const std::filesystem::path& data);

    /// Starts a synchronous standby of `primary`.
    /// @param data  directory to create for its data; empty: a temporary one, as for a primary
    explicit PostgresServer(const PostgresServer& primary, const std::filesystem::path& data = {});

    /// Creates an empty database. A user `locked`, if one is created, needs a password. @return its address for --store
    [[nodiscard]] std::string new_database();

    /// Returns the folder of the socket.
    [[nodiscard]] const std::string& socket() const { return directory_.path().native(); }

    /// Drops its data and becomes a synchronous standby of `primary`. Pre: it does not run.
    void stand_by(const PostgresServer& primary);

    /// Makes a primary of a standby.
    void promote();

    /// Stops its processes at once, as a paused machine does.
    void pause();

    /// Lets them go on after pause().
    void resume();

    /// Kills its processes, so that it does not shut down in order.
    void kill();

    /// Starts it again after kill().
    void start();

private:
    static std::filesystem::path place();
    void create();
    [[nodiscard]] std::string try_to_start();

    TemporaryDirectory directory_{place()};
    std::filesystem::path data_;
    bool is_synced_ = false; // its data survives a power failure
    int databases_ = 0;
    std::optional<ChildProcess> process_;
};

/// Connects to a database, and tries again if it answers late, as it does while other programs use all processors.
/// @param address  as for --store
[[nodiscard]] store::postgres::Connection connect(const std::string& address);

} // namespace scanloom::test
