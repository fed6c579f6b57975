#pragma once

#include "tests/support/child_process.hpp"
#include "tests/support/temporary_directory.hpp"

#include <optional>
#include <string>

namespace scanloom::test {

/// A server of PostgreSQL of its own, with a socket in a temporary directory and without a port. The destructor stops
/// it and removes its files. Run as root, it is started as the user `postgres`, whom Debian's package creates.
/// Errors: throws std::runtime_error if PostgreSQL is not installed or does not start.
class PostgresServer {
public:
    PostgresServer();

    /// Starts a standby of `primary`, whose name in synchronous_standby_names is `standby`.
    explicit PostgresServer(const PostgresServer& primary);

    /// Creates an empty database. @return its address for --store
    [[nodiscard]] std::string new_database();

    /// Returns the folder of the socket.
    [[nodiscard]] const std::string& socket() const { return directory_.path().native(); }

    /// Makes a primary of a standby.
    void promote();

    /// Kills it, so that it does not shut down in order.
    void kill();

    /// Starts it again after kill().
    void start();

private:
    [[nodiscard]] std::string try_to_start();

    TemporaryDirectory directory_;
    int databases_ = 0;
    std::optional<ChildProcess> process_;
};

} // namespace scanloom::test
