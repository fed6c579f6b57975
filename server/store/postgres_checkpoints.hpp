#pragma once

#include "common/error/error.hpp"
#include "server/store/postgres_size_limit.hpp"
#include "server/store/postgres_writer.hpp"
#include "server/store/scan_log.hpp"

#include <vector>

namespace scanloom::store::postgres {

/// Changes the checkpoints of sessions that this server owns, each in one transaction.
/// Errors of all functions: kNotFound, kNotOwner; kOverloaded: the size limit is reached; kStoreFailed.
/// Threads: any.
class Checkpoints {
public:
    /// @param access, shared, size_limit  must outlive the checkpoints
    Checkpoints(const WriteAccess& access, SharedState& shared, SizeLimit& size_limit)
        : shared_(shared), size_limit_(size_limit), writer_(access, shared) {}

    /// Removes all parts.
    [[nodiscard]] Result<> clear(SessionId session);

    /// Replaces the named parts; other parts stay.
    [[nodiscard]] Result<> write(SessionId session, const std::vector<CheckpointPart>& parts);

    /// Closes the connection.
    void close() { writer_.close(); }

private:
    [[nodiscard]] Result<> change(SessionId session, const Writer::Change& change_parts);

    SharedState& shared_;
    SizeLimit& size_limit_;
    Writer writer_;
};

} // namespace scanloom::store::postgres
