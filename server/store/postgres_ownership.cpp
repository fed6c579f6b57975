#include "server/store/postgres_ownership.hpp"

#include <fmt/format.h>

#include <chrono>

namespace scanloom::store::postgres {
namespace {

/// @param rows  with id, epoch and last entry
OwnedSessions sessions_in(const Rows& rows) {
    OwnedSessions sessions;
    for (int row = 0; row < rows.size(); ++row) {
        sessions[static_cast<SessionId>(rows.number(row, 0))] = {rows.number(row, 1),
                                                                 static_cast<Revision>(rows.number(row, 2))};
    }
    return sessions;
}

Result<OwnedSessions> take(Connection& connection, const char* statement, std::int64_t owner,
                           std::chrono::milliseconds timeout) {
    Parameters parameters;
    parameters.add(owner);
    const auto rows = connection.run(statement, parameters, timeout);
    if (!rows) return rows.error();
    return sessions_in(*rows);
}

/// Returns whether a session is in the database and not removed.
Result<bool> exists(Connection& connection, SessionId session) {
    Parameters parameters;
    parameters.add(signed_of(session));
    const auto rows = connection.run("SELECT id FROM scanloom.session WHERE id = $1 AND NOT removed", parameters);
    if (!rows) return rows.error();
    return rows->size() > 0;
}

} // namespace

Error taken_over(SessionId session) {
    return {Errc::kStoreFailed, fmt::format("another server has taken over session {} in the database; stop one of the "
                                            "two, or give it a database of its own",
                                            session)};
}

Result<> lock_store(Connection& connection, const Place& place) {
    // A server that has just been killed has the lock until the database notices it.
    if (auto patient = connection.run("SET lock_timeout = 500"); !patient) return patient.error();
    const auto locked = connection.run("SELECT pg_advisory_lock(hashtext('scanloom'), 1)");
    if (!locked && locked.error().code == Errc::kConflict) {
        return Error{Errc::kConflict,
                     fmt::format("another server uses the store {}; stop it, or give this one a database "
                                 "of its own",
                                 place.text)};
    }
    if (!locked) return locked.error();
    const auto reset = connection.run("SET lock_timeout = 0");
    return reset ? Result<>() : Result<>(reset.error());
}

Result<std::int64_t> new_owner(Connection& connection) {
    const auto rows = connection.run("SELECT nextval('scanloom.owner')");
    if (!rows) return rows.error();
    return rows->number(0, 0);
}

Result<OwnedSessions> take_all(Connection& connection, std::int64_t owner) {
    return take(
        connection,
        "UPDATE scanloom.session SET owner = $1, epoch = epoch + 1 WHERE NOT removed RETURNING id, epoch, end_rev",
        owner, Connection::kLongTimeout);
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

Result<OwnedSessions> take_again(Connection& connection, const Place& place, std::int64_t owner,
                                 const OwnedSessions& known) {
    auto taken = take(connection,
                      "UPDATE scanloom.session SET epoch = epoch + 1 WHERE owner = $1 AND NOT removed"
                      " RETURNING id, epoch, end_rev",
                      owner, Connection::kWriteTimeout); // readers wait meanwhile
    if (!taken) return taken;
    for (const auto& [session, owned] : known) {
        const auto now = taken->find(session);
        if (now == taken->end()) {
            const auto is_there = exists(connection, session);
            if (!is_there) return is_there.error();
            if (*is_there) return taken_over(session);
        } else if (now->second.end < owned.end) {
            return Error{
                Errc::kDataLoss,
                fmt::format("the database {} has lost entries: session {} ends with {}, and {} was acknowledged; "
                            "it went back to an earlier state, as after a failover without a synchronous standby",
                            place.text, session, now->second.end, owned.end)};
        }
    }
    return taken;
}

} // namespace scanloom::store::postgres
