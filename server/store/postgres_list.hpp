#pragma once

#include "common/error/error.hpp"
#include "server/store/postgres_connection.hpp"
#include "server/store/postgres_node.hpp"
#include "server/store/postgres_owned_sessions.hpp"
#include "server/store/shared_sessions.hpp"

#include <cstdint>
#include <optional>
#include <string_view>

/// What a server reads about the others: SharedSessions::list() and find().
namespace scanloom::store::postgres {

/// Returns all nodes, and the sessions that have a name.
/// @param self   this server's node
/// @param owned  the sessions that this server believes to own
[[nodiscard]] Result<SharedList> list_sessions(Connection& connection, const OwnNode& self, const OwnedSessions& owned);

/// Returns the session with this name; nullopt: there is none.
/// @param self  the number of this server's node
[[nodiscard]] Result<std::optional<FoundSession>> find_session(Connection& connection, std::string_view name,
                                                               std::int64_t self);

} // namespace scanloom::store::postgres
