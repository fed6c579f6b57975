#pragma once

#include "common/error/error.hpp"
#include "server/store/committer.hpp"
#include "server/store/compaction.hpp"
#include "server/store/directory.hpp"
#include "server/store/files_watch.hpp"
#include "server/store/rocksdb_store.hpp"

#include <rocksdb/db.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::store {

/// The end of each session's log and the id of the next session. Changes are checked against them.
struct LogEnds {
    SessionId next_session = 1;
    std::map<SessionId, Revision> revisions; ///< of each session's last entry, 0 for an empty log
    std::map<SessionId, Error> damaged;      ///< sessions whose last entry cannot be found; never changes
};

/// Returns the revision of a session's last entry, 0 for an empty log. Reads only its key.
/// @param store  name of the store, for messages
/// Errors: kDataLoss: that part of the database cannot be read.
[[nodiscard]] Result<Revision> end_of_log(rocksdb::DB& database, const std::string& store, SessionId session);

/// An open RocksDB database that holds a store, with its lock, its only writer and what watches over its files.
///
/// Threads: any, unless a function says otherwise.
class Database {
public:
    /// Opens the store in a directory for writing; creates it if needed. Cuts off a write that a crash left unfinished.
    /// Errors: those of open_rocksdb().
    [[nodiscard]] static Result<std::unique_ptr<Database>>
    open(const std::filesystem::path& directory, LockedDirectory::Files files, const StoreOptions& options);

    /// Opens the store in a directory for reading and changes no byte of it.
    /// Errors: those of open_read_only().
    [[nodiscard]] static Result<std::unique_ptr<Database>> open_read_only(const std::filesystem::path& directory,
                                                                          const StoreOptions& options);

    /// Returns whether a file can be written and synced in the directory, and whether its disk has room to open the
    /// store: opening writes the entries of the write-ahead logs to tables before it deletes the logs.
    [[nodiscard]] static bool can_be_opened(const std::filesystem::path& directory, const StoreOptions& options);

    /// Writes the queued changes, then closes the database.
    ~Database();

    Database(const Database&) = delete;
    Database& operator=(const Database&) = delete;

    [[nodiscard]] rocksdb::DB& rocksdb() noexcept { return *opened_.database; }
    [[nodiscard]] Committer& committer() noexcept { return committer_; }

    /// Threads: `next_session` and `revisions`: the committer's; `damaged`: any.
    [[nodiscard]] LogEnds& ends() noexcept { return ends_; }

    /// Returns the directory as a string, for messages.
    [[nodiscard]] const std::string& name() const noexcept { return opened_.directory.path().native(); }

    /// Checks that the store is still in its place. RocksDB opens tables by path, so it would read a store that took
    /// the place of this one.
    /// Errors: kStoreFailed: it is not.
    [[nodiscard]] Result<> check_files() { return opened_.files ? opened_.files->check() : Result<>(); }

    /// Frees the disk space of a removed session. Deletes tables that contain nothing else immediately. Compactions
    /// remove the rest, see compaction_of_removals(), but only once the removal is in a table: so the memtable is
    /// flushed first if there is room. A failure only costs disk space, because the remaining entries belong to no
    /// session.
    void free_disk(SessionId session);

    /// Returns the sessions that have entries or checkpoint parts but no record. Unreadable data is reported when the
    /// sessions are read.
    /// Pre: the database is read-only.
    [[nodiscard]] std::vector<SessionId> owners_without_record();

    [[nodiscard]] StoreStats stats() const;

private:
    /// An open database, and how it was found.
    struct Opened {
        LockedDirectory directory;
        std::unique_ptr<rocksdb::DB> database;
        std::uint64_t torn_bytes = 0; // of the write that a crash left unfinished
        std::shared_ptr<CompactionWatch> watch;
        std::unique_ptr<FilesWatch> files{}; // null for a read-only database
    };

    [[nodiscard]] static Result<std::unique_ptr<Database>> read_ends(Opened opened, const StoreOptions& options);
    Database(Opened opened, LogEnds ends, const StoreOptions& options);
    void continue_without_compaction(const rocksdb::Status& reason);

    Opened opened_;
    LogEnds ends_;
    CompactionSwitch compactions_;
    std::function<void(const Error&)> on_damage_;
    mutable std::mutex damage_mutex_;
    std::optional<Error> damage_; // guarded by damage_mutex_
    Committer committer_;         // last: stops before the members that it uses are destroyed
};

} // namespace scanloom::store
