#pragma once

#include "common/error/error.hpp"
#include "server/store/postgres_connection.hpp"
#include "server/store/postgres_owned_sessions.hpp"

#include <cstdint>
#include <vector>

/// Which server may write a session: the one that was the last to raise its epoch.
namespace scanloom::store::postgres {

struct Taker {
    std::int64_t node = 0;
    bool is_steady = false; ///< OwnNode::is_steady()
};

/// Makes a node the owner of a session that has no owner that lives, and raises its epoch: earlier owners change
/// nothing any more, and what they have committed is durable. A copy that has not replaced its session yet belongs to
/// the owner of that one.
/// @param taker  the number of the node, and whether it may take the sessions of nodes whose rows are old
/// Errors: kNotFound; kNotOwner: another node owns it; kStoreFailed.
[[nodiscard]] Result<OwnedSession> take(Connection& connection, SessionId session, const Taker& taker);

/// Makes it a session without an owner, if `owned` is still true.
[[nodiscard]] Result<> give_up(Connection& connection, SessionId session, const OwnedSession& owned);

/// Returns the sessions of all owners.
[[nodiscard]] Result<OwnedSessions> all_sessions(Connection& connection);

/// Returns the sessions that have entries or parts of a checkpoint, but no record. Takes as long as reading the store.
[[nodiscard]] Result<std::vector<SessionId>> sessions_without_record(Connection& connection);

/// Raises the epochs of the sessions that a node still owns, so that its earlier statements have no effect any more.
/// @param known  its sessions, with the last acknowledged entry of each
/// @return its sessions, with the last stored entry of each; those that others have taken are left out
/// Errors: kDataLoss: the database has lost acknowledged entries; kStoreFailed.
[[nodiscard]] Result<OwnedSessions> take_again(Connection& connection, const Place& place, std::int64_t node,
                                               const OwnedSessions& known);

/// Checks that a session still has the epoch of this server.
/// Errors: kNotFound, kNotOwner, kStoreFailed.
[[nodiscard]] Result<> confirm_owned(Connection& connection, SessionId session, const OwnedSession& owned);

/// Finds out why a statement had no effect on a session that this server believed to own, and forgets the session if it
/// does not own it.
/// @return kNotFound: it was removed; kNotOwner: another node has taken it; kStoreFailed: its log does not end where
///         this server expected, or the database cannot be used
[[nodiscard]] Error forget_lost(Connection& connection, SharedState& shared, SessionId session,
                                const OwnedSession& owned);

/// Returns why a session that this server does not own cannot be changed: kNotFound, kNotOwner or kStoreFailed.
[[nodiscard]] Error why_not_owned(Connection& connection, SessionId session);

} // namespace scanloom::store::postgres
