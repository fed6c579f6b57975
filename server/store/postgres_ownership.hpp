#pragma once

#include "common/error/error.hpp"
#include "server/store/postgres_connection.hpp"
#include "server/store/postgres_owned_sessions.hpp"

#include <cstdint>
#include <vector>

/// Which server may write a session: the one that was the last to raise its epoch.
namespace scanloom::store::postgres {

/// Locks the store for one server, as long as the connection exists. The lock only keeps two servers apart that are
/// started by mistake; what a server writes is safe by its epochs.
/// Errors: kConflict: another server has it; kStoreFailed.
[[nodiscard]] Result<> lock_store(Connection& connection, const Place& place);

/// Returns a number that no other server has had.
[[nodiscard]] Result<std::int64_t> new_owner(Connection& connection);

/// Takes over all sessions, whoever had them.
[[nodiscard]] Result<OwnedSessions> take_all(Connection& connection, std::int64_t owner);

/// Returns all sessions, whoever has them.
[[nodiscard]] Result<OwnedSessions> all_sessions(Connection& connection);

/// Returns the sessions that have entries or parts of a checkpoint, but no record. Takes as long as reading the store.
[[nodiscard]] Result<std::vector<SessionId>> sessions_without_record(Connection& connection);

/// Takes over all sessions that still are this server's, so that nothing of it is under way any more.
/// @param known  what the server had, and what of it was acknowledged
/// @return what is stored
/// Errors: kDataLoss: the database has lost acknowledged entries; kStoreFailed: another server has taken a session over,
///         or the database cannot be used.
[[nodiscard]] Result<OwnedSessions> take_again(Connection& connection, const Place& place, std::int64_t owner,
                                               const OwnedSessions& known);

} // namespace scanloom::store::postgres
