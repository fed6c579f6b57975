#pragma once

#include "server/store/postgres_connection.hpp"
#include "server/store/postgres_scan_log.hpp"
#include "tests/support/postgres_server.hpp"

#include <cstdint>
#include <string>
#include <utility>

namespace scanloom::store {

/// A database of a server that all tests of this program share, and what tests do to it behind the store's back.
/// Everything is in the schema `scanloom`, which the constructor removes.
struct PostgresDatabase {
    explicit PostgresDatabase(std::string database = shared()) : address(std::move(database)) {
        static_cast<void>(run("DROP SCHEMA IF EXISTS scanloom CASCADE"));
    }

    static test::PostgresServer& server() {
        static test::PostgresServer started;
        return started;
    }

    static const std::string& shared() {
        static const std::string made = server().new_database();
        return made;
    }

    [[nodiscard]] postgres::Rows run(const std::string& sql) const {
        return test::connect(address).run(sql.c_str()).value();
    }

    [[nodiscard]] std::int64_t number(const std::string& sql) const { return run(sql).number(0, 0); }

    /// The next insertion of entries fails, those after it succeed: a sequence goes on when a transaction fails.
    /// @param code  of PostgreSQL (SQLSTATE)
    void fail_next_insertion(const std::string& code = "P0001") const {
        static_cast<void>(run("CREATE SEQUENCE scanloom.insertions"));
        static_cast<void>(run("CREATE FUNCTION scanloom.fail_once() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN"
                              " IF nextval('scanloom.insertions') = 1 THEN RAISE EXCEPTION 'a test lets this fail'"
                              " USING ERRCODE = '" +
                              code +
                              "'; END IF;"
                              " RETURN NEW; END $$"));
        static_cast<void>(run("CREATE TRIGGER fail_once BEFORE INSERT ON scanloom.segment FOR EACH ROW"
                              " EXECUTE FUNCTION scanloom.fail_once()"));
    }

    /// Ends all connections to the database, as a restart of the server does.
    void end_connections() const {
        static_cast<void>( // a connection that has just ended by itself is a warning, which counts as a failure
            test::connect(address).run("SELECT pg_terminate_backend(pid, 5000) FROM pg_stat_activity"
                                       " WHERE datname = current_database() AND pid <> pg_backend_pid()"));
    }

    std::string address;
};

} // namespace scanloom::store
