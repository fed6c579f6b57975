#pragma once

#include "common/error/error.hpp"
#include "server/store/postgres_connection.hpp"
#include "server/store/postgres_owned_sessions.hpp"
#include "server/store/postgres_write_access.hpp"

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

    /// @param access, shared  must outlive the writer
    Writer(const WriteAccess& access, SharedState& shared) : access_(access), shared_(shared) {}

    /// Makes a change.
    /// Errors: those of the change; why the log has failed. kNotFound, kNotOwner, kAlreadyExists and kOverloaded mean
    ///         that nothing was changed. After another error, the log has failed: it is not known whether the change
    ///         took effect.
    [[nodiscard]] Result<> make(const Change& change);

    /// Closes the connection.
    void close();

private:
    const WriteAccess& access_;
    SharedState& shared_;
    std::mutex mutex_; // held during a change
    std::optional<Connection> connection_;
};

} // namespace scanloom::store::postgres
