#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_entry.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rocksdb {
class DB;
class Env;
} // namespace rocksdb

namespace scanloom::store {

/// A session's number in the store, from 1. Never reused, also not after deletion or restart.
using SessionId = std::uint64_t;

struct StoredSession {
    SessionId id = 0;
    Result<std::string> record;    ///< opaque bytes; kDataLoss: damaged
    std::optional<Error> damage{}; ///< of the log's end: nothing can be appended
};

/// One named part of a session's checkpoint, for example one chunk of its map. Opaque bytes.
struct CheckpointPart {
    std::string key;
    std::string value;

    friend bool operator==(const CheckpointPart&, const CheckpointPart&) = default;
};

/// What the store did since it was opened.
struct StoreStats {
    std::uint64_t appends = 0;             ///< calls of append() that became durable
    std::uint64_t entries = 0;             ///< log entries that became durable
    std::uint64_t synced_writes = 0;       ///< group commits, one fsync each
    std::uint64_t queued_bytes = 0;        ///< waiting for the committer
    std::uint64_t torn_bytes_dropped = 0;  ///< of a write the last crash cut short, never acknowledged
    std::optional<std::string> last_error; ///< why nothing is written any more
    std::optional<std::string> no_room;    ///< why nothing more is stored until the disk has room again
    std::optional<std::string> damage;     ///< found in the files while running; writing goes on
};

/// The truth: every session's append-only log of entries, and checkpoints of what was woven from them.
///
/// Order   All changes (sessions, entries, checkpoints) take effect in the order in which they were
///         handed over, and what a crash or power cut leaves is a prefix of them. So a checkpoint
///         that survives is never ahead of the log, provided it was handed over after the entries
///         it covers were; they need not be acknowledged yet.
/// Errors  kNotFound: no such session, or it was removed. kConflict: an append that does not
///         continue its session's log. kDataLoss: what was read is damaged. kStoreFailed:
///         reading or writing failed. After one failed write or sync every change fails, until the
///         store is opened again: what the disk holds is not known before that. Reading goes on.
/// Thread  any, at the same time. Everything but append() and stats() may wait for the disk: keep
///         it off the threads that serve sockets. From within `done` only append() may be called.
class ScanLog {
public:
    using Done = std::function<void(Result<>)>;
    using VisitEntry = std::function<Result<>(Revision, std::string_view)>;
    using CopyDatabase = std::function<Result<>(rocksdb::DB&)>;
    using VisitPart = std::function<Result<>(std::string_view key, std::string_view value)>;

    ScanLog() = default;
    ScanLog(const ScanLog&) = delete;
    ScanLog& operator=(const ScanLog&) = delete;

    /// Writes what still waits, calls every `done`, and closes.
    virtual ~ScanLog() = default;

    /// Durable when it returns.
    [[nodiscard]] virtual Result<SessionId> create_session(std::string_view record) = 0;

    /// All sessions, by rising id; damage of one holds up no other.
    [[nodiscard]] virtual Result<std::vector<StoredSession>> sessions() = 0;

    /// The revision of the session's last entry, 0 for an empty log.
    /// Errors  kNotFound; kDataLoss.
    [[nodiscard]] virtual Result<Revision> end_of(SessionId session) = 0;

    /// Durable when it returns: record, entries and checkpoint are gone. The disk is freed in time.
    [[nodiscard]] virtual Result<> remove_session(SessionId session) = 0;

    /// Appends entries first, first + 1, ..., all or none of them.
    ///
    /// Pre     `first` is one past the session's last entry, 1 for an empty log.
    /// Post    `done` is called exactly once, from the committer's thread, when the entries survive
    ///         kill -9 and power loss, or have failed. It should be quick and must not throw.
    ///         Everything that waits, of all sessions, becomes durable with one synced write.
    /// Errors  kOverloaded: the disk has no room; nothing was stored, and later there may be. kStoreFailed: it is not
    ///         known what is stored until the log is opened again.
    /// Queue   "commit queue". append() never waits and never refuses: the capacity is the sum of
    ///         the robots' credits, as credit is given back only when `done` was called.
    ///         Its size is stats().queued_bytes.
    virtual void append(SessionId session, Revision first, std::vector<std::string> entries, Done done) = 0;

    /// Visits the entries after `after` in order, of the log as it is now; stops at the visitor's error.
    ///
    /// Errors  kDataLoss, naming session and revision: a damaged entry; a missing one; a log that
    ///         ends before `after`, as a checkpoint ahead of its log would have it.
    [[nodiscard]] virtual Result<> read(SessionId session, Revision after, const VisitEntry& visit) = 0;

    /// Removes all parts. Takes its turn in the commit queue and returns when written.
    [[nodiscard]] virtual Result<> clear_checkpoint(SessionId session) = 0;

    /// Replaces the named parts, all or none of them; parts not named stay.
    /// Takes its turn in the commit queue and returns when written.
    [[nodiscard]] virtual Result<> write_checkpoint(SessionId session, std::vector<CheckpointPart> parts) = 0;

    /// Visits all parts by rising key; none if no checkpoint was written. Stops at the visitor's error.
    [[nodiscard]] virtual Result<> read_checkpoint(SessionId session, const VisitPart& visit) = 0;

    [[nodiscard]] virtual StoreStats stats() const = 0;

    /// Lets `copy` make a copy of the database behind the log, as Backups does, while everything else goes on.
    /// Errors  those of `copy`; kStoreFailed: the store has failed; kInvalidField: there is no database.
    [[nodiscard]] virtual Result<> copy_with(const CopyDatabase& copy);

    /// All files of the store.
    [[nodiscard]] virtual std::uint64_t bytes_on_disk() const = 0;
};

/// append(), and waits until it is durable or has failed.
/// Errors  as of ScanLog::append(). Thread  not the committer's.
[[nodiscard]] Result<> append_and_wait(ScanLog& log, SessionId session, Revision first,
                                       std::vector<std::string> entries);

struct StoreOptions {
    /// Bound of write buffers and block cache together. The default suits 1 GB of memory and 24 GB:
    /// the log is read in order, so more cache would hardly be used, and the system caches files.
    std::size_t memory_bytes = std::size_t{128} << 20;

    /// What is left free on the disk: with less, nothing is stored that adds to it, so that sessions can still be
    /// removed and tables merged. Changes are refused then, with kOverloaded, and nothing of them is stored.
    std::uint64_t disk_reserve_bytes = std::uint64_t{256} << 20;

    /// Called once, from a thread of the store, when a file turns out to be damaged while running. New entries are
    /// stored as before; what the file held is told when it is read.
    std::function<void(const Error&)> on_damage;

    /// Called with each line that RocksDB logs, from warnings on, from a thread of RocksDB. Null: they are dropped.
    std::function<void(std::string_view)> on_rocksdb_log;

    /// The file layer, for tests that fail it. Null: the system's.
    rocksdb::Env* env = nullptr;
};

/// Opens the store in a directory, creating both if there is nothing yet.
///
/// Errors  kConflict: it is in use by another process; kStoreFailed: the directory cannot be used, holds something
///         else, or the store in it is damaged; the message names the file. kUnsupportedVersion: it
///         was written by a newer program. A write that a crash cut short is no damage: it was never
///         acknowledged and is dropped.
[[nodiscard]] Result<std::unique_ptr<ScanLog>> open_rocksdb(const std::filesystem::path& directory,
                                                            const StoreOptions& options = {});

} // namespace scanloom::store
