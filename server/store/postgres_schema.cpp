#include "server/store/postgres_schema.hpp"

#include "common/text/parse_number.hpp"

#include <fmt/format.h>

#include <array>

namespace scanloom::store::postgres {
namespace {

constexpr std::array kFormat1 = {
    "CREATE SCHEMA scanloom",
    "CREATE TABLE scanloom.meta (key text PRIMARY KEY, value text NOT NULL)",
    "CREATE TABLE scanloom.session (id bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY, record bytea NOT NULL,"
    " owner bigint NOT NULL, epoch bigint NOT NULL DEFAULT 1, end_rev bigint NOT NULL DEFAULT 0,"
    " removed bool NOT NULL DEFAULT false) WITH (fillfactor = 50)",
    "CREATE TABLE scanloom.segment (session bigint NOT NULL, first bigint NOT NULL, last bigint NOT NULL,"
    " body bytea NOT NULL, PRIMARY KEY (session, first)) WITH (toast_tuple_target = 8160)",
    "ALTER TABLE scanloom.segment ALTER body SET STORAGE EXTERNAL", // not compressed again
    "CREATE TABLE scanloom.part (session bigint NOT NULL, key bytea NOT NULL, value bytea NOT NULL,"
    " PRIMARY KEY (session, key))",
    "ALTER TABLE scanloom.part ALTER value SET STORAGE EXTERNAL",
    "CREATE SEQUENCE scanloom.owner",
    "INSERT INTO scanloom.meta VALUES ('format', '1')",
};

Result<> check_format(Connection& connection) {
    const auto rows = connection.run("SELECT value FROM scanloom.meta WHERE key = 'format'");
    if (!rows) return rows.error();
    const auto format = rows->size() == 1 ? parse_number<int>(rows->bytes(0, 0)) : std::nullopt;
    if (!format) return Error{Errc::kDataLoss, "the database has a schema scanloom that is not a store"};
    if (*format <= kFormat) return {};
    return Error{
        Errc::kUnsupportedVersion,
        fmt::format("the store in the database has format {}, and this program knows {}; use the newer program "
                    "that wrote it",
                    *format, kFormat)};
}

Result<> create(Connection& connection) {
    // One server creates the tables at a time; the lock ends with the transaction.
    if (auto locked = connection.run("SELECT pg_advisory_xact_lock(hashtext('scanloom'), 0)"); !locked)
        return locked.error();
    if (auto found = check_tables(connection); found || found.error().code != Errc::kNotFound) return found;
    for (const char* statement : kFormat1) {
        if (auto done = connection.run(statement); !done) return done.error();
    }
    return {};
}

} // namespace

Result<> check_tables(Connection& connection) {
    const auto rows = connection.run("SELECT (to_regclass('scanloom.meta') IS NOT NULL)::int::bigint");
    if (!rows) return rows.error();
    if (rows->number(0, 0) != 0) return check_format(connection);
    return Error{Errc::kNotFound, "the database holds no store"};
}

Result<> create_tables(Connection& connection) {
    if (auto begun = connection.run("BEGIN"); !begun) return begun.error();
    auto created = create(connection);
    const auto ended = connection.run(created ? "COMMIT" : "ROLLBACK");
    if (created && !ended) return ended.error();
    return created;
}

} // namespace scanloom::store::postgres
