#pragma once

#include "common/error/error.hpp"
#include "server/store/directory.hpp"
#include "server/store/rocksdb_store.hpp"
#include "server/store/scan_log.hpp"

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::store {

/// Reads the intact sessions and log entries of a damaged store, in place and without changing it. Checkpoints are
/// ignored, because maps are computed again from the log.
///
/// Each table is read by itself, because a bad block in one would hide what others contain. Every readable block of a
/// table counts (BlockScan), and every complete write of a write-ahead log, also those after damage. A table whose
/// index cannot be read is lost. Removed sessions are recognized as long as the manifest names every table. Otherwise
/// only removals in the write-ahead logs are known, and a session that was removed reappears if its table still exists.
/// Memory: the records and entries of the write-ahead logs.
/// Threads: one.
class DamagedStore {
public:
    /// Errors: kNotFound: there is no store; kConflict: a server has it open; kStoreFailed: it is an unfinished store,
    ///         or a file may not be opened (permissions). Such a file is not treated as lost, because its entries would
    ///         be lost silently.
    [[nodiscard]] static Result<std::unique_ptr<DamagedStore>> open(const std::filesystem::path& store,
                                                                    const StoreOptions& options = {});
    ~DamagedStore();

    /// Returns the records by session id; nullopt for a session that has entries but no intact record.
    [[nodiscard]] const std::map<SessionId, std::optional<std::string>>& sessions() const noexcept { return sessions_; }

    /// Visits the intact entries of a session's log by ascending revision; entries between them are lost.
    /// @return number of entries with a wrong checksum in blocks that can be read
    /// Errors: those of the visitor.
    [[nodiscard]] Result<std::uint64_t> read(SessionId session, const ScanLog::VisitEntry& visit) const;

    /// Returns sentences that describe what is damaged and what was kept of it.
    [[nodiscard]] const std::vector<std::string>& notes() const noexcept { return notes_; }

    [[nodiscard]] std::size_t damaged_files() const noexcept { return damaged_.size(); }

private:
    struct Rocksdb; // its options and the database

    /// A table that can be opened, and the range of its keys; if an end of it is unknown, the range is unlimited there.
    struct Table {
        std::filesystem::path file;
        std::string smallest;
        std::string largest;
    };

    DamagedStore(LockedDirectory directory, const StoreOptions& options);
    [[nodiscard]] Result<> open_files() const;
    void open_tables();
    void open_catalog();
    [[nodiscard]] Result<> read_write_ahead_logs();
    [[nodiscard]] Result<std::string> read_file(const std::filesystem::path& file);
    void find_sessions();
    [[nodiscard]] bool is_removed(SessionId session) const;
    void note_damage(const std::filesystem::path& file, std::string_view how);

    const LockedDirectory directory_;
    const StoreOptions options_;
    const std::unique_ptr<Rocksdb> rocksdb_;
    std::vector<Table> tables_;
    std::map<std::string, std::string> logged_; // records and entries of the write-ahead logs, sealed, by key
    std::set<SessionId> removed_;               // by the write-ahead logs
    std::map<SessionId, std::optional<std::string>> sessions_;
    std::set<std::string> damaged_; // names of files
    std::vector<std::string> notes_;
};

} // namespace scanloom::store
