#include "server/store/postgres_checkpoints.hpp"

#include "server/store/postgres_append_queue.hpp"
#include "server/store/postgres_ownership.hpp"
#include "server/store/postgres_segments.hpp"

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

namespace scanloom::store::postgres {

/// Changes a checkpoint in one transaction. Its last statement checks that this server still owns the session.
Result<> Checkpoints::change(SessionId session, const Writer::Change& change_parts) {
    return writer_.make([&](Connection& connection) -> Result<> {
        const auto owned = shared_.find(session);
        if (!owned) return why_not_owned(connection, session);
        if (auto begun = connection.run("BEGIN"); !begun) return begun.error();
        if (auto changed = change_parts(connection); !changed) return changed;
        Parameters parameters;
        parameters.add(signed_of(session));
        parameters.add(owned->epoch);
        const auto rows = connection.run("UPDATE scanloom.session SET checkpoint_bytes = (SELECT"
                                         " coalesce(sum(octet_length(value)), 0) FROM scanloom.part WHERE session = $1)"
                                         " WHERE id = $1 AND epoch = $2 AND NOT removed RETURNING id",
                                         parameters);
        if (!rows) return rows.error();
        if (rows->size() == 0) return forget_lost(connection, shared_, session, *owned);
        const auto committed = connection.run("COMMIT");
        return committed ? Result<>() : Result<>(committed.error());
    });
}

Result<> Checkpoints::clear(SessionId session) {
    return change(session, [&](Connection& connection) -> Result<> {
        Parameters parameters;
        parameters.add(signed_of(session));
        const auto cleared =
            connection.run("DELETE FROM scanloom.part WHERE session = $1", parameters, Connection::kLongTimeout);
        return cleared ? Result<>() : Result<>(cleared.error());
    });
}

Result<> Checkpoints::write(SessionId session, const std::vector<CheckpointPart>& parts) {
    std::map<std::string_view, std::string> sealed_parts; // a statement accepts each key once
    for (const CheckpointPart& part : parts) sealed_parts[part.key] = sealed_part(session, part.key, part.value);
    return change(session, [&](Connection& connection) -> Result<> {
        if (auto room = size_limit_.check(connection); !room) return room;
        for (auto part = sealed_parts.begin(); part != sealed_parts.end();) {
            std::vector<std::string_view> keys;
            std::vector<std::string_view> values;
            std::size_t bytes = 0;
            for (; part != sealed_parts.end() && bytes < AppendQueue::kStatementBytes; ++part) {
                keys.push_back(part->first);
                values.push_back(part->second);
                bytes += part->second.size();
            }
            size_limit_.add(bytes);
            Parameters parameters;
            parameters.add(signed_of(session));
            parameters.add(keys);
            parameters.add(values);
            const auto written =
                connection.run("INSERT INTO scanloom.part (session, key, value) SELECT $1, p.key, p.value"
                               " FROM unnest($2::bytea[], $3::bytea[]) AS p(key, value)"
                               " ON CONFLICT (session, key) DO UPDATE SET value = excluded.value",
                               parameters);
            if (!written) return written.error();
        }
        return {};
    });
}

} // namespace scanloom::store::postgres
