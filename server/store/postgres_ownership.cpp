#include "server/store/postgres_ownership.hpp"

#include "server/store/postgres_node.hpp"
#include "server/store/store_error.hpp"

#include <fmt/format.h>

#include <chrono>
#include <optional>
#include <string>

namespace scanloom::store::postgres {
namespace {

/// A row of the table of sessions, with its owner.
struct State {
    std::int64_t epoch = 0;
    std::int64_t owner = 0;             // 0: none, or one that is gone
    std::string name;                   // or the number of a session without one
    bool is_old = false;                // the owner has not renewed its row for some time
    std::string place;                  // of the owner: its name, and its address if it has announced it
    std::int64_t owner_of_original = 0; // of the session that this copy is to replace; 0: it is no such copy
};

/// @param rows  with id, epoch and last entry
OwnedSessions sessions_in(const Rows& rows) {
    OwnedSessions sessions;
    for (int row = 0; row < rows.size(); ++row) {
        sessions[static_cast<SessionId>(rows.number(row, 0))] = {rows.number(row, 1),
                                                                 static_cast<Revision>(rows.number(row, 2))};
    }
    return sessions;
}

/// Returns the state of a session; nullopt: it does not exist, or is removed.
Result<std::optional<State>> state_of(Connection& connection, SessionId session) {
    Parameters parameters;
    parameters.add(signed_of(session));
    parameters.add(std::int64_t{kDeadAfter.count()});
    const auto rows =
        connection.run("SELECT s.epoch, coalesce(n.id, 0), (n.seen < now() - make_interval(secs => $2))::int::bigint,"
                       " coalesce(n.name || CASE WHEN n.http = '' THEN '' ELSE ' at ' || n.http END, ''),"
                       " coalesce(original.owner, 0), coalesce(s.name, s.id::text)"
                       " FROM scanloom.session s LEFT JOIN scanloom.node n ON n.id = s.owner"
                       " LEFT JOIN scanloom.session original ON original.id = s.replaces AND NOT original.removed"
                       " WHERE s.id = $1 AND NOT s.removed",
                       parameters);
    if (!rows) return rows.error();
    if (rows->size() == 0) return std::optional<State>();
    return std::optional(State{rows->number(0, 0), rows->number(0, 1), std::string(rows->bytes(0, 5)),
                               rows->number(0, 2) != 0, std::string(rows->bytes(0, 3)), rows->number(0, 4)});
}

Error not_owner(const State& state) {
    if (state.owner == 0) {
        return {Errc::kNotOwner,
                fmt::format("this server does not own session '{}', and no other server does; try again", state.name)};
    }
    if (state.is_old) {
        return {Errc::kNotOwner,
                fmt::format("session '{}' belongs to node {}, which does not answer; another server takes it over in a "
                            "few seconds; try again",
                            state.name, state.place)};
    }
    return {Errc::kNotOwner, fmt::format("session '{}' belongs to node {}; connect there", state.name, state.place)};
}

} // namespace

Result<OwnedSession> take(Connection& connection, SessionId session, const Taker& taker) {
    for (;;) { // until no other node is faster
        const auto state = state_of(connection, session);
        if (!state) return state.error();
        if (!*state) return no_such_session(session);
        const auto owner = (*state)->owner;
        const bool is_free = owner == 0 || owner == taker.node || ((*state)->is_old && taker.is_steady) ||
                             (*state)->owner_of_original == taker.node;
        if (!is_free) return not_owner(**state);
        Parameters parameters;
        parameters.add(signed_of(session));
        parameters.add((*state)->epoch);
        parameters.add(taker.node);
        const auto rows = connection.run("UPDATE scanloom.session SET owner = $3, epoch = epoch + 1"
                                         " WHERE id = $1 AND epoch = $2 AND NOT removed RETURNING epoch, end_rev",
                                         parameters);
        if (!rows) return rows.error();
        if (rows->size() > 0) return OwnedSession{rows->number(0, 0), static_cast<Revision>(rows->number(0, 1))};
    }
}

Result<> give_up(Connection& connection, SessionId session, const OwnedSession& owned) {
    Parameters parameters;
    parameters.add(signed_of(session));
    parameters.add(owned.epoch);
    const auto rows = connection.run(
        "UPDATE scanloom.session SET owner = 0, epoch = epoch + 1 WHERE id = $1 AND epoch = $2", parameters);
    return rows ? Result<>() : Result<>(rows.error());
}

Result<OwnedSessions> all_sessions(Connection& connection) {
    const auto rows = connection.run("SELECT id, epoch, end_rev FROM scanloom.session WHERE NOT removed", {},
                                     Connection::kLongTimeout);
    if (!rows) return rows.error();
    return sessions_in(*rows);
}

Result<std::vector<SessionId>> sessions_without_record(Connection& connection) {
    constexpr std::chrono::hours kTimeout{24};
    const auto rows = connection.run("SELECT session FROM (SELECT session FROM scanloom.segment UNION"
                                     " SELECT session FROM scanloom.part) AS u WHERE NOT EXISTS"
                                     " (SELECT FROM scanloom.session WHERE id = u.session) ORDER BY session",
                                     {}, kTimeout);
    if (!rows) return rows.error();
    std::vector<SessionId> sessions;
    for (int row = 0; row < rows->size(); ++row) sessions.push_back(static_cast<SessionId>(rows->number(row, 0)));
    return sessions;
}

Result<OwnedSessions> take_again(Connection& connection, const Place& place, std::int64_t node,
                                 const OwnedSessions& known) {
    Parameters parameters;
    parameters.add(node);
    const auto rows = connection.run("UPDATE scanloom.session SET epoch = epoch + 1 WHERE owner = $1 AND NOT removed"
                                     " RETURNING id, epoch, end_rev",
                                     parameters); // readers wait meanwhile
    if (!rows) return rows.error();
    auto taken = sessions_in(*rows);
    const auto went_back = [&](SessionId session, std::string_view how) {
        return Error{Errc::kDataLoss,
                     fmt::format("the database {} has lost entries: session {} {}; it went back to an earlier state, "
                                 "as after a failover without a synchronous standby; bring the later state back, or "
                                 "restart all servers to go on with this one",
                                 place.text, session, how)};
    };
    for (const auto& [session, owned] : known) {
        const auto now = taken.find(session);
        if (now != taken.end() && now->second.end < owned.end) {
            return went_back(session, fmt::format("ends with {}, and {} was acknowledged", now->second.end, owned.end));
        }
        if (now != taken.end()) continue;
        const auto state = state_of(connection, session);
        if (!state) return state.error();
        if (*state && (*state)->epoch <= owned.epoch) return went_back(session, "has an owner that it had before");
    }
    return taken;
}

Result<> confirm_owned(Connection& connection, SessionId session, const OwnedSession& owned) {
    // A commit is confirmed by the standby, so that a primary which another one has replaced cannot make it.
    Parameters parameters;
    parameters.add(signed_of(session));
    parameters.add(owned.epoch);
    const auto rows = connection.run("UPDATE scanloom.session SET epoch = epoch"
                                     " WHERE id = $1 AND epoch = $2 AND NOT removed RETURNING id",
                                     parameters);
    if (!rows) return rows.error();
    return rows->size() > 0 ? Result<>() : Result<>(why_not_owned(connection, session));
}

Error forget_lost(Connection& connection, SharedState& shared, SessionId session, const OwnedSession& owned) {
    const auto state = state_of(connection, session);
    if (!state) return state.error();
    if (!*state || (*state)->epoch != owned.epoch) shared.remove(session);
    if (!*state) return no_such_session(session);
    if ((*state)->epoch != owned.epoch) return not_owner(**state);
    return failure(
        "the log of session '{}' in the database does not end with {}; this server finds out what is stored, "
        "and goes on",
        (*state)->name, owned.end);
}

Error why_not_owned(Connection& connection, SessionId session) {
    const auto state = state_of(connection, session);
    if (!state) return state.error();
    return *state ? not_owner(**state) : no_such_session(session);
}

} // namespace scanloom::store::postgres
