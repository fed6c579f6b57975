#pragma once

#include "common/error/error.hpp"
#include "server/store/scan_log.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

/// The store in a database of PostgreSQL 15 or newer.
namespace scanloom::store {

struct PostgresOptions {
    /// Accept a database that has no synchronous standby: the loss of its machine loses acknowledged scans.
    bool allow_unreplicated = false;

    /// This server's name among those that share the store. One that is started later with the same name has its
    /// sessions at once.
    std::string node = "scanloom-server";

    /// Refuse to store more, with kOverloaded, when all entries and checkpoints together have this size. nullopt: no
    /// limit.
    std::optional<std::uint64_t> bytes_max;

    /// Begin an empty store, which cannot be opened otherwise until finish_postgres().
    bool is_unfinished = false;

    /// Called on the reader's thread for every log that ScanLog::read() could not read to its end, with kDataLoss or
    /// kStoreFailed.
    std::function<void(SessionId, const Error&)> on_unreadable;
};

/// Opens the store in a database, which other servers may share; creates its tables if they do not exist.
///
/// Only sessions that this server owns can be changed; see SharedSessions. Errors of changes: also kNotOwner.
/// Several connections append: a session always uses the same one, and changes of different sessions may take effect
/// in another order than they were submitted. A session's checkpoint is never ahead of its log.
/// @param url  postgresql://USER@HOST[:PORT][,HOST[:PORT]...]/DATABASE; the one that accepts writes is used
/// Errors: kInvalidField: `url` is not an address; kConflict: an unfinished store is to be begun, and there is one;
///         kStoreFailed: the database cannot be used, or is not replicated, or a program uses the store alone;
///         kUnsupportedVersion: it is too old, or a newer program wrote the store.
[[nodiscard]] Result<std::unique_ptr<ScanLog>> open_postgres(const std::string& url,
                                                             const PostgresOptions& options = {});

/// Ends the writing of a store that was opened as an unfinished one. Precondition: it is closed.
/// Errors: kStoreFailed: it stays unfinished.
[[nodiscard]] Result<> finish_postgres(const std::string& url);

/// Opens the store in a database for reading, while no server uses it, and changes nothing of it.
/// Errors: kNotFound: there is none; otherwise as open_postgres().
[[nodiscard]] Result<ReadOnlyStore> open_postgres_read_only(const std::string& url);

} // namespace scanloom::store
