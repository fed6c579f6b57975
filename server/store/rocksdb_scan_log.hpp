#pragma once

#include "server/store/database.hpp"
#include "server/store/rocksdb_store.hpp"
#include "server/store/scan_log.hpp"

#include <rocksdb/write_batch.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <shared_mutex>

namespace scanloom::store {

/// A scan log in RocksDB. Readers use the database directly; changes go through its committer.
///
/// After a failed write or sync nothing is retried on the same files: reopen() closes the database, reads what is
/// there, as after a crash, and writes it to new files.
class RocksdbScanLog final : public ScanLog {
public:
    /// Opens a log for reading and writing.
    /// Errors: those of open_rocksdb().
    [[nodiscard]] static Result<std::unique_ptr<ScanLog>>
    open(const std::filesystem::path& directory, LockedDirectory::Files files, const StoreOptions& options);

    /// A log that cannot be reopened, for reading.
    RocksdbScanLog(std::unique_ptr<Database> database, const StoreOptions& options);

    [[nodiscard]] Result<SessionId> create_session(std::string_view record) override;
    [[nodiscard]] Result<std::vector<StoredSession>> sessions() override;
    [[nodiscard]] Result<Revision> end_of(SessionId session) override;
    [[nodiscard]] Result<> remove_session(SessionId session) override;
    void append(SessionId session, Revision first, std::vector<std::string> entries, Done done) override;
    [[nodiscard]] Result<> read(SessionId session, Revision after, const VisitEntry& visit) override;
    [[nodiscard]] Result<> clear_checkpoint(SessionId session) override;
    [[nodiscard]] Result<> write_checkpoint(SessionId session, std::vector<CheckpointPart> parts) override;
    [[nodiscard]] Result<> read_checkpoint(SessionId session, const VisitPart& visit) override;

    /// Reopens the store as soon as its disk can be written and has room to open it, and only if its lock file is still
    /// the original one. A store that was deleted or replaced is not reopened; that requires a restart.
    [[nodiscard]] bool reopen() override;
    [[nodiscard]] StoreStats stats() const override;
    [[nodiscard]] Result<std::string> identity() override;
    [[nodiscard]] Result<> backup_to(const std::filesystem::path& directory, const std::stop_token& stop) override;
    [[nodiscard]] std::uint64_t bytes_on_disk() const override;

private:
    /// The database, which stays open while this exists.
    struct Use {
        std::shared_lock<std::shared_mutex> lock;
        Database& database;
    };
    [[nodiscard]] Result<Use> use() const;
    [[nodiscard]] Result<Use> use_for(SessionId session) const;

    /// Adds a change to a write, or returns an error and adds nothing.
    using AddTo = std::function<Result<>(LogEnds&, rocksdb::WriteBatch&)>;
    [[nodiscard]] Result<> commit(std::uint64_t bytes, const AddTo& add_to, bool frees_disk = false);
    [[nodiscard]] Result<> read_entries(SessionId session, Revision after, const VisitEntry& visit);

    const std::filesystem::path directory_;
    const StoreOptions options_;
    LockedDirectory::Files files_ = LockedDirectory::Files::kComplete; // accepted by reopen()
    std::optional<HeldFile> lock_file_;                                // of the store; nullopt: read-only
    mutable std::shared_mutex mutex_;                                  // held shared during use of the database
    std::unique_ptr<Database> database_;                               // null: it could not be reopened yet
    StoreStats before_; // of the databases that were closed; last_error says why database_ is null
};

} // namespace scanloom::store
