#include "server/store/postgres_write_access.hpp"

#include "server/store/store_error.hpp"

#include <fmt/format.h>

namespace scanloom::store::postgres {

Result<> lock_store(Connection& connection, const Place& place, Sharing sharing) {
    // A server that has just been killed has the lock until the database notices it.
    if (auto patient = connection.run("SET lock_timeout = 500"); !patient) return patient.error();
    const auto locked =
        connection.run(sharing == Sharing::kAlone ? "SELECT pg_advisory_lock(hashtext('scanloom'), 1)"
                                                  : "SELECT pg_advisory_lock_shared(hashtext('scanloom'), 1)");
    if (!locked && locked.error().code == Errc::kConflict) {
        return Error{Errc::kConflict, fmt::format("another program uses the store {}{}; stop it, or name another "
                                                  "database",
                                                  place.text, sharing == Sharing::kAlone ? "" : " alone")};
    }
    if (!locked) return locked.error();
    const auto reset = connection.run("SET lock_timeout = 0");
    return reset ? Result<>() : Result<>(reset.error());
}

Result<Connection> WriteAccess::open() const {
    auto connection = Connection::open(place);
    if (!connection) return connection;
    if (!allow_unreplicated) {
        const auto risk = connection->replication_fault();
        if (!risk) return risk.error();
        if (*risk) return failure("{}; change this, or start with --allow-unreplicated", **risk);
    }
    if (sharing == Sharing::kAlone) return connection;
    if (auto locked = lock_store(*connection, place, sharing); !locked) return failure("{}", locked.error().message);
    return connection;
}

} // namespace scanloom::store::postgres
