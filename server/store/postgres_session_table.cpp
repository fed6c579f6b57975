#include "server/store/postgres_session_table.hpp"

#include "server/store/postgres_ownership.hpp"
#include "server/store/postgres_session_name.hpp"

#include <fmt/format.h>

namespace scanloom::store::postgres {

Result<SessionId> SessionTable::create(std::string_view record) {
    SessionId session = 0;
    const auto created = writer_.make([&](Connection& connection) -> Result<> {
        if (auto room = size_limit_.check(connection); !room) return room;
        const auto [name, replaces] = name_in(record);
        Parameters parameters;
        parameters.add(record);
        parameters.add(node_.id());
        parameters.add(std::string_view(name));
        parameters.add(signed_of(replaces));
        const auto rows =
            connection.run("WITH original AS (SELECT id FROM scanloom.session WHERE id = $4 AND NOT removed)"
                           " INSERT INTO scanloom.session (record, owner, name, replaces) VALUES ($1, $2,"
                           " CASE WHEN EXISTS (SELECT FROM original) THEN NULL"
                           " ELSE nullif(convert_from($3, 'UTF8'), '') END, (SELECT id FROM original))"
                           " ON CONFLICT (name) WHERE NOT removed DO NOTHING RETURNING id, epoch",
                           parameters);
        if (!rows) return rows.error();
        if (rows->size() == 0) {
            return Error{Errc::kAlreadyExists, fmt::format("session '{}' exists already; choose another name or "
                                                           "delete it first",
                                                           name)};
        }
        session = static_cast<SessionId>(rows->number(0, 0));
        shared_.put(session, {rows->number(0, 1), 0});
        return {};
    });
    if (!created) return created.error();
    return session;
}

Result<> SessionTable::own(SessionId session) {
    return writer_.make([&](Connection& connection) -> Result<> {
        if (const auto known = shared_.find(session)) {
            auto confirmed = confirm_owned(connection, session, *known);
            if (confirmed || confirmed.error().code != Errc::kNotOwner) return confirmed;
            shared_.remove(session); // another server took it while this one was paused
        }
        const auto owned = take(connection, session, {node_.id(), node_.is_steady()});
        if (!owned) return owned.error();
        shared_.put(session, *owned);
        return {};
    });
}

Result<> SessionTable::disown(SessionId session) {
    return writer_.make([&](Connection& connection) -> Result<> {
        const auto owned = shared_.find(session);
        auto given = owned ? give_up(connection, session, *owned) : Result<>();
        if (given) shared_.remove(session);
        return given;
    });
}

Result<> SessionTable::remove(SessionId session) {
    return writer_.make([&](Connection& connection) -> Result<> {
        const auto owned = shared_.find(session);
        if (!owned) return why_not_owned(connection, session);
        Parameters parameters;
        parameters.add(signed_of(session));
        parameters.add(owned->epoch);
        // The copy that replaces the session gets its name at once, before another server can use it.
        const auto rows = connection.run("WITH gone AS (UPDATE scanloom.session SET removed = true, record = ''"
                                         " WHERE id = $1 AND epoch = $2 AND NOT removed RETURNING id, name),"
                                         " named AS (UPDATE scanloom.session s SET name = gone.name, replaces = NULL"
                                         " FROM gone WHERE s.replaces = gone.id)"
                                         " SELECT id FROM gone",
                                         parameters);
        if (!rows) return rows.error();
        if (rows->size() == 0) return forget_lost(connection, shared_, session, *owned);
        shared_.remove(session);
        return {};
    });
}

} // namespace scanloom::store::postgres
