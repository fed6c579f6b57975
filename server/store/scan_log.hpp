#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_entry.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::store {

/// A session's number in the store, from 1. Never reused, even after deletion or restart.
using SessionId = std::uint64_t;

struct StoredSession {
    SessionId id = 0;
    Result<std::string> record;    ///< opaque bytes; kDataLoss: damaged
    std::optional<Error> damage{}; ///< of the log's end; if set, nothing can be appended
};

/// One named part of a session's checkpoint, for example one chunk of its map. Opaque bytes.
struct CheckpointPart {
    std::string key;
    std::string value;

    friend bool operator==(const CheckpointPart&, const CheckpointPart&) = default;
};

/// Statistics since the program opened the store, over all reopenings.
struct StoreStats {
    std::uint64_t appends = 0;             ///< calls of append() that became durable
    std::uint64_t entries = 0;             ///< log entries that became durable
    std::uint64_t synced_writes = 0;       ///< group commits, one fsync each
    std::uint64_t queued_bytes = 0;        ///< waiting for the committer
    std::uint64_t torn_bytes_dropped = 0;  ///< of a write that the last crash cut short, never acknowledged
    std::optional<std::string> last_error; ///< why the store accepts no more changes
    std::optional<std::string> no_room;    ///< why nothing is stored until the disk has room again
    std::optional<std::string> damage;     ///< found in the files at run time; writing continues
    std::optional<std::string> warning;    ///< configuration fault that does not stop the store
};

/// Whether a visitor receives the next item.
enum class Visit : std::uint8_t { kContinue, kStop };

class SharedSessions;

/// What a visitor returns: a Visit, or an error, with which the visit fails. A Result<> without an error continues.
class Visited : public Result<Visit> {
public:
    using Result<Visit>::Result;
    Visited() : Result<Visit>(Visit::kContinue) {}
    Visited(const Result<>& done) : Result<Visit>(done ? Result<Visit>(Visit::kContinue) : done.error()) {}
};

/// The durable state of all sessions: an append-only log of entries for each, and checkpoints of the maps computed from
/// it.
///
/// Order: All changes (sessions, entries, checkpoints) take effect in the order of submission, and a crash or power
///        loss leaves a prefix of them. A checkpoint that survives is therefore never ahead of the log, if it was
///        submitted after the entries that it covers; they need not be acknowledged yet.
/// Errors: kNotFound: there is no such session, or it was removed. kNotOwner: another server may change it, if several
///         share the log (shared()). kAlreadyExists: so may its name, for a new session. kConflict: an append does not
///         continue its session's log. kDataLoss: the data read is damaged. kStoreFailed: reading or writing failed.
///         After one failed write or sync it is unknown what is stored, so every change fails until reopen() succeeds;
///         reading continues.
/// Threads: any, concurrently. All functions except append() and stats() may wait for the disk: do not call them on
///          threads that serve sockets. Within a `done`, only append() may be called.
class ScanLog {
public:
    using Done = std::function<void(Result<>)>;
    using VisitEntry = std::function<Visited(Revision, std::string_view)>;
    using VisitPart = std::function<Result<>(std::string_view key, std::string_view value)>;

    ScanLog() = default;
    ScanLog(const ScanLog&) = delete;
    ScanLog& operator=(const ScanLog&) = delete;

    /// Writes queued changes, calls every `done`, and closes the log.
    virtual ~ScanLog() = default;

    /// Creates a session; durable on return.
    [[nodiscard]] virtual Result<SessionId> create_session(std::string_view record) = 0;

    /// Returns all sessions by ascending id. Damage of one does not affect the others.
    [[nodiscard]] virtual Result<std::vector<StoredSession>> sessions() = 0;

    /// Returns the revision of the session's last entry, 0 for an empty log.
    /// Errors: kNotFound: no such session; kDataLoss: the end of its log cannot be read.
    [[nodiscard]] virtual Result<Revision> end_of(SessionId session) = 0;

    /// Removes a session's record, entries and checkpoint; durable on return. Disk space is freed later.
    [[nodiscard]] virtual Result<> remove_session(SessionId session) = 0;

    /// Appends entries first, first + 1, ..., all or none of them.
    ///
    /// Pre: `first` is one past the session's last entry, 1 for an empty log.
    /// Post: `done` is called exactly once, on a thread of the log, when the entries have failed or survive kill -9 and
    ///       power loss. It should be quick and must not throw. One synced write makes all queued changes of all
    ///       sessions durable.
    /// Errors: kOverloaded: the disk has no room; nothing was stored, and a later attempt may succeed. kStoreFailed: it
    ///         is unknown what is stored until reopen() succeeds.
    /// Queue: "commit queue". append() never waits and never refuses: the capacity is the sum of the robots' credits,
    ///        because credit is returned only after `done` was called. Its size is stats().queued_bytes.
    virtual void append(SessionId session, Revision first, std::vector<std::string> entries, Done done) = 0;

    /// Visits the entries after revision `after` in order, up to the end of the log at the time of the call, or until
    /// the visitor stops.
    ///
    /// Errors: those of the visitor; kDataLoss, naming session and revision: an entry is damaged or missing,
    ///         or the log ends before `after`, as after a checkpoint that is ahead of its log.
    [[nodiscard]] virtual Result<> read(SessionId session, Revision after, const VisitEntry& visit) = 0;

    /// Removes all parts. Goes through the commit queue and returns when written.
    [[nodiscard]] virtual Result<> clear_checkpoint(SessionId session) = 0;

    /// Replaces the named parts, all or none of them; other parts stay. Goes through the commit queue and returns when
    /// written.
    [[nodiscard]] virtual Result<> write_checkpoint(SessionId session, std::vector<CheckpointPart> parts) = 0;

    /// Visits all parts by ascending key; none if no checkpoint was written. Stops at the visitor's error.
    [[nodiscard]] virtual Result<> read_checkpoint(SessionId session, const VisitPart& visit) = 0;

    /// Makes a log that failed usable again, if its storage can be written now.
    ///
    /// Waits for readers in progress. While the log is being reopened, append() fails and the other functions wait.
    /// @return whether the log had failed and accepts changes again. If so, each caller of append() has to check with
    ///         end_of() which of its entries were stored.
    [[nodiscard]] virtual bool reopen() = 0;

    [[nodiscard]] virtual StoreStats stats() const = 0;

    /// Returns the identity of the store, which is the same after a restart and in a store that was restored from a
    /// backup.
    /// Errors: kInvalidField: this kind of log has no backups; kStoreFailed.
    [[nodiscard]] virtual Result<std::string> identity();

    /// Makes a backup of everything that is durable at the time of the call, in a directory of backups of this store.
    /// Other operations continue meanwhile.
    ///
    /// @param stop  when requested, ends the backup soon with kShuttingDown
    /// Errors: kConflict: the directory has backups of another store; kInvalidField: this kind of log has no backups;
    ///         kShuttingDown; kStoreFailed: the log has failed, or a disk cannot be read or written. A failed backup
    ///         leaves no files.
    [[nodiscard]] virtual Result<> backup_to(const std::filesystem::path& directory, const std::stop_token& stop);

    /// Returns the total size of the store's files, in bytes.
    [[nodiscard]] virtual std::uint64_t bytes_on_disk() const = 0;

    /// Returns what the servers that share the log need to know of each other's sessions; null: one server uses the
    /// log alone, and owns all sessions.
    [[nodiscard]] virtual SharedSessions* shared() { return nullptr; }
};

/// A store that no server has open, for reading.
struct ReadOnlyStore {
    std::unique_ptr<ScanLog> log;          ///< every change fails
    std::uint64_t unfinished_bytes = 0;    ///< of a write that a crash cut short; not damage: the next start drops it
    std::vector<SessionId> without_record; ///< sessions with entries or checkpoint parts but without a record
};

/// Appends entries and waits until they are durable or have failed.
/// Errors: those of ScanLog::append().
/// Threads: not from within a `done`.
[[nodiscard]] Result<> append_and_wait(ScanLog& log, SessionId session, Revision first,
                                       std::vector<std::string> entries);

} // namespace scanloom::store
