#pragma once

#include "common/error/error.hpp"
#include "server/store/postgres_connection.hpp"
#include "server/store/postgres_owned_sessions.hpp"

#include <functional>
#include <mutex>
#include <optional>

namespace scanloom::store::postgres {

/// Changes the database, one change at a time, and waits for the result of each. Opens a new connection if the last one
/// was lost.
/// Threads: any.
class Writer {
public:
    using Change = std::function<Result<>(Connection&)>;

    /// @param shared  must outlive the writer
    Writer(const Place& place, SharedState& shared) : place_(place), shared_(shared) {}

    /// Makes a change.
    /// Errors: those of the change; why the log has failed. kNotFound, kNotOwner, kAlreadyExists and kOverloaded mean
    ///         that nothing was changed. After another error, the log has failed: it is not known whether the change
    ///         took effect.
    [[nodiscard]] Result<> make(const Change& change);

    /// Closes the connection.
    void close();

private:
    const Place& place_;
    SharedState& shared_;
    std::mutex mutex_; // held during a change
    std::optional<Connection> connection_;
};

} // namespace scanloom::store::postgres
