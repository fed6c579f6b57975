#pragma once

#include "common/error/error.hpp"
#include "server/store/scan_log.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rocksdb {
class DB;
}

namespace scanloom::store {

/// What can still be read of a store, however damaged: its sessions and the entries of their logs. Checkpoints are
/// left: maps are woven anew.
///
/// Reads a copy, which shares the tables' files with the store where the disk allows it: what is never changed need not
/// be copied. Tables are read each by itself, as one with a bad block would hide what others have, and of one that is
/// damaged every intact entry is taken (carve_table); of the write-ahead log every whole write is, also behind damage;
/// a manifest that is damaged, or names tables that are missing, is made again from the tables that are there. A
/// session that was deleted shortly before may come back then.
/// Thread  one.
class Salvage {
public:
    /// @param copy  a directory that does not exist; it is gone with this.
    /// Errors  kNotFound, kConflict (a server has it open), kStoreFailed: the copy cannot be made or be read at all.
    [[nodiscard]] static Result<std::unique_ptr<Salvage>>
    open(const std::filesystem::path& store, const std::filesystem::path& copy, const StoreOptions& options = {});
    ~Salvage();
    Salvage(const Salvage&) = delete;
    Salvage& operator=(const Salvage&) = delete;

    /// By id; nothing: of this session there are entries, but no intact record.
    [[nodiscard]] const std::map<SessionId, std::optional<std::string>>& sessions() const noexcept { return sessions_; }

    using VisitEntry = std::function<Result<>(Revision, std::string_view)>;

    /// The intact entries of a session's log, by rising revision; those between them are lost. Stops at the visitor's
    /// error. @return how many were found whose checksum does not hold.
    [[nodiscard]] Result<std::uint64_t> read(SessionId session, const VisitEntry& visit) const;

    /// What was done to have it read, a sentence for each file that is damaged.
    [[nodiscard]] const std::vector<std::string>& notes() const noexcept { return notes_; }

private:
    /// A table file and the keys it may have.
    struct Table {
        std::filesystem::path file;
        std::string smallest;
        std::string largest;
    };

    explicit Salvage(std::filesystem::path copy);
    [[nodiscard]] Result<> copy_files(const std::filesystem::path& store);
    [[nodiscard]] Result<> open_tables(const std::filesystem::path& store, const StoreOptions& options);
    [[nodiscard]] Result<> set_unlisted_aside(const std::filesystem::path& store);
    [[nodiscard]] Result<> carve_damaged_tables();
    [[nodiscard]] Result<std::uint64_t> carve(const std::filesystem::path& table);
    [[nodiscard]] Result<> take_write_ahead_logs(const std::filesystem::path& store);
    void list_tables();
    void find_sessions();
    void find_records(const Table& table);
    void find_owners(const Table& table);
    [[nodiscard]] bool is_removed(SessionId session, const std::filesystem::path& table) const;

    const std::filesystem::path copy_;
    std::unique_ptr<rocksdb::DB> database_; // of the copy
    bool has_all_tables_ = false;           // those that its own manifest names
    std::vector<Table> tables_;
    std::map<SessionId, std::optional<std::string>> sessions_;
    std::vector<std::string> notes_;
};

} // namespace scanloom::store
