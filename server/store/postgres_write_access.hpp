#pragma once

#include "common/error/error.hpp"
#include "server/store/postgres_connection.hpp"

#include <cstdint>

namespace scanloom::store::postgres {

/// Who else may have the store open.
enum class Sharing : std::uint8_t { kWithNodes, kAlone };

/// Locks the store, as long as the connection exists, so that a program that needs it alone does not run with a
/// server. What servers write is safe without it, by the epochs.
/// Errors: kConflict: another program has it, or has it alone; kStoreFailed.
[[nodiscard]] Result<> lock_store(Connection& connection, const Place& place, Sharing sharing);

/// How this program opens connections that write to sessions.
struct WriteAccess {
    Place place;
    Sharing sharing = Sharing::kWithNodes;
    bool allow_unreplicated = false;

    /// Connects to a database that is replicated, unless it need not be. With other nodes, each connection locks the
    /// store, so that no program has it alone while one of them exists.
    /// Errors: kStoreFailed: also if it is not replicated, or another program has the store alone.
    [[nodiscard]] Result<Connection> open() const;
};

} // namespace scanloom::store::postgres
