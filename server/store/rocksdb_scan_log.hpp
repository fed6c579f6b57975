#pragma once

#include "server/store/committer.hpp"
#include "server/store/compaction.hpp"
#include "server/store/directory.hpp"
#include "server/store/scan_log.hpp"

#include <rocksdb/db.h>

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>

namespace scanloom::store {

/// The end of each session's log and the id of the next session. Changes are checked against them.
struct LogEnds {
    SessionId next_session = 1;
    std::map<SessionId, Revision> revisions; ///< of each session's last entry, 0 for an empty log
    std::map<SessionId, Error> damaged;      ///< sessions whose last entry cannot be found; never changes
};

/// A scan log in RocksDB. Readers use the database directly; changes go through the committer.
class RocksdbScanLog final : public ScanLog {
public:
    /// @param files  null for a read-only database
    RocksdbScanLog(LockedDirectory directory, std::unique_ptr<rocksdb::DB> database, LogEnds ends,
                   std::uint64_t torn_bytes_dropped, std::shared_ptr<CompactionWatch> watch,
                   std::unique_ptr<FilesWatch> files, const StoreOptions& options);
    ~RocksdbScanLog() override;

    [[nodiscard]] Result<SessionId> create_session(std::string_view record) override;
    [[nodiscard]] Result<std::vector<StoredSession>> sessions() override;
    [[nodiscard]] Result<Revision> end_of(SessionId session) override;
    [[nodiscard]] Result<> remove_session(SessionId session) override;
    void append(SessionId session, Revision first, std::vector<std::string> entries, Done done) override;
    [[nodiscard]] Result<> read(SessionId session, Revision after, const VisitEntry& visit) override;
    [[nodiscard]] Result<> clear_checkpoint(SessionId session) override;
    [[nodiscard]] Result<> write_checkpoint(SessionId session, std::vector<CheckpointPart> parts) override;
    [[nodiscard]] Result<> read_checkpoint(SessionId session, const VisitPart& visit) override;
    [[nodiscard]] Result<> copy_with(const CopyDatabase& copy) override;
    [[nodiscard]] StoreStats stats() const override;
    [[nodiscard]] std::uint64_t bytes_on_disk() const override;

private:
    [[nodiscard]] Result<> check_files();
    [[nodiscard]] Result<> check_session(SessionId session);
    [[nodiscard]] std::string name() const { return directory_.path().native(); }
    void free_disk(SessionId session);
    void go_on_without_compaction(const rocksdb::Status& reason);

    LockedDirectory directory_;
    std::unique_ptr<rocksdb::DB> database_;
    LogEnds ends_; // used on the committer's thread only
    std::uint64_t torn_bytes_dropped_;
    std::shared_ptr<CompactionWatch> watch_;
    CompactionSwitch compactions_;
    std::unique_ptr<FilesWatch> files_; // may be null
    std::function<void(const Error&)> on_damage_;
    mutable std::mutex damage_mutex_;
    std::optional<Error> damage_; // guarded by damage_mutex_
    Committer committer_;         // last: stops before the members that it uses are destroyed
};

} // namespace scanloom::store
