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

/// Makes `owner` the owner of all sessions, and raises their epochs.
[[nodiscard]] Result<OwnedSessions> take_all(Connection& connection, std::int64_t owner);

/// Returns the sessions of all owners.
[[nodiscard]] Result<OwnedSessions> all_sessions(Connection& connection);

/// Returns the sessions that have entries or parts of a checkpoint, but no record. Takes as long as reading the store.
[[nodiscard]] Result<std::vector<SessionId>> sessions_without_record(Connection& connection);

/// Raises the epochs of the sessions that `owner` still owns, so that its earlier statements have no effect any more.
/// @param known  its sessions, with the last acknowledged entry of each
/// @return its sessions, with the last stored entry of each
/// Errors: kDataLoss: the database has lost acknowledged entries; kStoreFailed: another server has taken a session over,
///         or the database cannot be used.
[[nodiscard]] Result<OwnedSessions> take_again(Connection& connection, const Place& place, std::int64_t owner,
                                               const OwnedSessions& known);

} // namespace scanloom::store::postgres
