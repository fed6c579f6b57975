#pragma once

#include "common/error/error.hpp"
#include "server/store/postgres_node.hpp"
#include "server/store/postgres_size_limit.hpp"
#include "server/store/postgres_writer.hpp"
#include "server/store/scan_log.hpp"

#include <string_view>

namespace scanloom::store::postgres {

/// Creates, takes, gives up and removes sessions.
/// Errors of all functions: those of Writer::make().
/// Threads: any.
class SessionTable {
public:
    /// @param access, shared, size_limit, node  must outlive the table
    SessionTable(const WriteAccess& access, SharedState& shared, SizeLimit& size_limit, const OwnNode& node)
        : shared_(shared), size_limit_(size_limit), node_(node), writer_(access, shared) {}

    /// Creates a session, which this node owns.
    /// Errors: also kAlreadyExists: there is a session with the name in the record; kOverloaded: the size limit is
    ///         reached.
    [[nodiscard]] Result<SessionId> create(std::string_view record);

    /// Makes this node the owner of a session, if it is not.
    /// Errors: also those of take().
    [[nodiscard]] Result<> own(SessionId session);

    /// Gives a session up, if this node owns it. Precondition: nothing is appended to it meanwhile.
    [[nodiscard]] Result<> disown(SessionId session);

    /// Marks a session as removed; its rows are deleted later. A copy that replaces it gets its name.
    /// Errors: also kNotFound, kNotOwner.
    [[nodiscard]] Result<> remove(SessionId session);

    /// Closes the connection.
    void close() { writer_.close(); }

private:
    SharedState& shared_;
    SizeLimit& size_limit_;
    const OwnNode& node_;
    Writer writer_;
};

} // namespace scanloom::store::postgres
