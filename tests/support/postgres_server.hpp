#pragma once

#include "tests/support/child_process.hpp"
#include "tests/support/temporary_directory.hpp"

#include <string>

namespace scanloom::test {

/// A server of PostgreSQL of its own, with a socket in a temporary directory and without a port. The destructor stops
/// it and removes its files. Run as root, it is started as the user `postgres`, whom Debian's package creates.
/// Errors: throws std::runtime_error if PostgreSQL is not installed or does not start.
class PostgresServer {
public:
    PostgresServer();

    /// Creates an empty database. @return its address for --store
    [[nodiscard]] std::string new_database();

private:
    TemporaryDirectory directory_;
    int databases_ = 0;
    std::optional<ChildProcess> process_;
};

} // namespace scanloom::test
