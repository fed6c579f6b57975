#include "server/store/postgres_schema.hpp"

#include "common/text/parse_number.hpp"
#include "server/store/postgres_session_name.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::store::postgres {
namespace {

constexpr std::array kFormat1 = {
    "CREATE SCHEMA scanloom",
    "CREATE TABLE scanloom.meta (key text PRIMARY KEY, value text NOT NULL)",
    "CREATE TABLE scanloom.session (id bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY, record bytea NOT NULL,"
    " owner bigint NOT NULL, epoch bigint NOT NULL DEFAULT 1, end_rev bigint NOT NULL DEFAULT 0,"
    " entry_bytes bigint NOT NULL DEFAULT 0, checkpoint_bytes bigint NOT NULL DEFAULT 0,"
    " removed bool NOT NULL DEFAULT false) WITH (fillfactor = 50)",
    "CREATE TABLE scanloom.segment (session bigint NOT NULL, first bigint NOT NULL, last bigint NOT NULL,"
    " body bytea NOT NULL, PRIMARY KEY (session, first)) WITH (toast_tuple_target = 8160)",
    "ALTER TABLE scanloom.segment ALTER body SET STORAGE EXTERNAL", // not compressed again
    "CREATE TABLE scanloom.part (session bigint NOT NULL, key bytea NOT NULL, value bytea NOT NULL,"
    " PRIMARY KEY (session, key))",
    "ALTER TABLE scanloom.part ALTER value SET STORAGE EXTERNAL",
};

// What format 2 adds: the servers that use the store, and names by which they find each other's sessions. Owners of
// format 1 are numbers that a node could have.
constexpr std::array kFormat2 = {
    "CREATE TABLE scanloom.node (id bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY, name text NOT NULL UNIQUE,"
    " robots text NOT NULL DEFAULT '', http text NOT NULL DEFAULT '', build text NOT NULL DEFAULT '',"
    " seen timestamptz NOT NULL)",
    "ALTER TABLE scanloom.session ADD COLUMN name text, ADD COLUMN replaces bigint",
    "CREATE UNIQUE INDEX session_name ON scanloom.session (name) WHERE NOT removed",
    "CREATE INDEX session_replaces ON scanloom.session (replaces) WHERE replaces IS NOT NULL",
    "DROP SEQUENCE IF EXISTS scanloom.owner",
    "UPDATE scanloom.session SET owner = 0",
    "INSERT INTO scanloom.meta VALUES ('secret', encode(sha256((gen_random_uuid()::text || gen_random_uuid()::text)"
    "::bytea), 'hex'))",
    "INSERT INTO scanloom.meta VALUES ('format', '2') ON CONFLICT (key) DO UPDATE SET value = excluded.value",
};

Result<bool> is_unfinished(Connection& connection) {
    const auto rows = connection.run("SELECT count(*) FROM scanloom.meta WHERE key = 'unfinished'");
    if (!rows) return rows.error();
    return rows->number(0, 0) > 0;
}

/// Returns the format of the store.
Result<int> format_of(Connection& connection) {
    const auto rows = connection.run("SELECT value FROM scanloom.meta WHERE key = 'format'");
    if (!rows) return rows.error();
    const auto format = rows->size() == 1 ? parse_number<int>(rows->bytes(0, 0)) : std::nullopt;
    if (!format)
        return Error{Errc::kDataLoss, "the database has a schema scanloom that is not a store; name another database"};
    if (*format <= kFormat) return *format;
    return Error{
        Errc::kUnsupportedVersion,
        fmt::format("the store in the database has format {}, and this program knows {}; use the newer program "
                    "that wrote it",
                    *format, kFormat)};
}

Result<bool> has_tables(Connection& connection) {
    const auto rows = connection.run("SELECT (to_regclass('scanloom.meta') IS NOT NULL)::int::bigint");
    if (!rows) return rows.error();
    return rows->number(0, 0) != 0;
}

Result<> run_all(Connection& connection, std::span<const char* const> statements) {
    for (const char* statement : statements) {
        if (auto done = connection.run(statement); !done) return done.error();
    }
    return {};
}

/// Does something in a transaction, in one program at a time.
Result<> in_transaction(Connection& connection, Result<> (*change)(Connection&)) {
    if (auto begun = connection.run("BEGIN"); !begun) return begun.error();
    // The lock ends with the transaction.
    const auto locked = connection.run("SELECT pg_advisory_xact_lock(hashtext('scanloom'), 0)");
    const auto changed = locked ? change(connection) : Result<>(locked.error());
    const auto ended = connection.run(changed ? "COMMIT" : "ROLLBACK");
    if (changed && !ended) return ended.error();
    return changed;
}

/// Writes the names of the sessions of format 1, which only their records have. Of two sessions with one name, which
/// only a fault can have stored, the first gets it. A copy gets it only if what it replaces is gone.
Result<> fill_in_names(Connection& connection) {
    const auto rows = connection.run("SELECT id, record FROM scanloom.session WHERE NOT removed ORDER BY id", {},
                                     Connection::kLongTimeout);
    if (!rows) return rows.error();
    std::set<std::int64_t> ids;
    for (int row = 0; row < rows->size(); ++row) ids.insert(rows->number(row, 0));
    std::set<std::string> taken;
    for (int row = 0; row < rows->size(); ++row) {
        const auto [name, replaces] = name_in(rows->bytes(row, 1));
        const bool is_copy = ids.contains(signed_of(replaces));
        const bool is_new = !is_copy && !name.empty() && taken.insert(name).second;
        Parameters parameters;
        parameters.add(rows->number(row, 0));
        parameters.add(std::string_view(is_new ? name : std::string()));
        parameters.add(is_copy ? signed_of(replaces) : 0);
        const auto named = connection.run("UPDATE scanloom.session SET name = nullif(convert_from($2, 'UTF8'), ''),"
                                          " replaces = nullif($3, 0) WHERE id = $1",
                                          parameters);
        if (!named) return named.error();
    }
    return {};
}

Result<> create_all(Connection& connection) {
    if (auto created = run_all(connection, kFormat1); !created) return created;
    return run_all(connection, kFormat2);
}

Result<> create_or_migrate(Connection& connection) {
    const auto found = check_tables(connection);
    if (!found && found.error().code == Errc::kNotFound) return create_all(connection);
    if (!found) return found;
    const auto format = format_of(connection);
    if (!format) return format.error();
    if (*format == kFormat) return {};
    if (auto added = run_all(connection, kFormat2); !added) return added;
    return fill_in_names(connection);
}

Result<> replace_unfinished(Connection& connection) {
    const auto is_present = has_tables(connection);
    if (!is_present) return is_present.error();
    if (*is_present) {
        const auto unfinished = is_unfinished(connection);
        if (!unfinished) return unfinished.error();
        if (!*unfinished) {
            return Error{Errc::kConflict,
                         "there is a store in the database; name a database without one, or remove it with "
                         "DROP SCHEMA scanloom CASCADE"};
        }
        if (auto removed = connection.run("DROP SCHEMA scanloom CASCADE"); !removed) return removed.error();
    }
    if (auto created = create_all(connection); !created) return created;
    const auto marked = connection.run("INSERT INTO scanloom.meta VALUES ('unfinished', 'a copy')");
    return marked ? Result<>() : Result<>(marked.error());
}

} // namespace

Result<> check_tables(Connection& connection) {
    const auto is_present = has_tables(connection);
    if (!is_present) return is_present.error();
    if (!*is_present) return Error{Errc::kNotFound, "the database holds no store; name the one that servers use"};
    if (const auto format = format_of(connection); !format) return format.error();
    const auto unfinished = is_unfinished(connection);
    if (!unfinished) return unfinished.error();
    if (!*unfinished) return {};
    return Error{Errc::kStoreFailed,
                 "the store in the database is unfinished: --copy has not finished writing it; wait for "
                 "it, or run it again"};
}

Result<> create_tables(Connection& connection) { return in_transaction(connection, create_or_migrate); }

Result<> begin_unfinished_store(Connection& connection) { return in_transaction(connection, replace_unfinished); }

Result<std::string> read_secret(Connection& connection) {
    const auto rows = connection.run("SELECT value FROM scanloom.meta WHERE key = 'secret'");
    if (!rows) return rows.error();
    if (rows->size() == 1) return std::string(rows->bytes(0, 0));
    return Error{Errc::kDataLoss,
                 "the store in the database has lost the secret of its servers; restore the database from a "
                 "backup"};
}

Result<> finish_store(Connection& connection) {
    const auto finished = connection.run("DELETE FROM scanloom.meta WHERE key = 'unfinished'");
    return finished ? Result<>() : Result<>(finished.error());
}

} // namespace scanloom::store::postgres
