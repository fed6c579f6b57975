#pragma once

#include "common/error/error.hpp"
#include "server/store/scan_log.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace rocksdb {
class DB;
}

namespace scanloom::store {

/// The tables of a damaged store, and in them whatever is intact of it, as well as its write-ahead logs.
///
/// Tables are read each by itself, as one with a bad block would hide what others have, and of one that is damaged
/// every intact entry is taken (carve_table); of the write-ahead log every whole write is, also behind damage; a
/// manifest that is damaged, or names tables that are missing, is made again from the tables that are there. What the
/// disk cannot read is passed over, 4 KiB at a time.
/// Thread  one.
class SalvagedTables {
public:
    /// A table file and the keys it may have.
    struct Table {
        std::filesystem::path file;
        std::string smallest;
        std::string largest;
    };

    /// @param copy  a directory that does not exist; it is gone with this. Tables are shared with the store where the
    ///              disk allows it: what is never changed need not be copied.
    /// Errors  kStoreFailed: the copy cannot be made, a file cannot be opened (rights), or nothing can be read at all.
    [[nodiscard]] static Result<std::unique_ptr<SalvagedTables>>
    open(const std::filesystem::path& store, const std::filesystem::path& copy, const StoreOptions& options);
    ~SalvagedTables();
    SalvagedTables(const SalvagedTables&) = delete;
    SalvagedTables& operator=(const SalvagedTables&) = delete;

    [[nodiscard]] const std::vector<Table>& all() const noexcept { return all_; }

    /// Whether the session, of which a table has something, was removed later. Where tables are missing or damaged that
    /// may not be known.
    [[nodiscard]] bool is_removed(SessionId session) const;

    /// What was done to have them read: sentences.
    [[nodiscard]] const std::vector<std::string>& notes() const noexcept { return notes_; }

    [[nodiscard]] std::size_t damaged_files() const noexcept { return damaged_.size(); }

private:
    SalvagedTables(std::filesystem::path store, std::filesystem::path copy, const StoreOptions& options);
    [[nodiscard]] Result<> copy_files();
    [[nodiscard]] Result<> open_database();
    [[nodiscard]] Result<> set_all_aside();
    [[nodiscard]] Result<> set_unlisted_aside();
    [[nodiscard]] std::vector<std::filesystem::path> files() const;
    [[nodiscard]] Result<> take_damaged();
    [[nodiscard]] Result<std::uint64_t> carve(const std::filesystem::path& table);
    [[nodiscard]] Result<> take_write_ahead_logs();
    void list();
    void note_why_not(const std::string& reason);
    [[nodiscard]] Result<std::string> read(const std::filesystem::path& file);
    [[nodiscard]] Result<> copy(const std::filesystem::path& file, const std::filesystem::path& to);
    void is_damaged(const std::filesystem::path& file, std::string_view how);

    const std::filesystem::path store_;
    const std::filesystem::path copy_;
    const StoreOptions options_;
    std::unique_ptr<rocksdb::DB> database_; // of the copy
    bool has_all_ = false;                  // those that its own manifest names
    std::set<SessionId> removed_;           // where not all are there: what those that are tell
    std::vector<Table> all_;
    std::set<std::string> damaged_; // files of the store, by name
    std::vector<std::string> notes_;
};

} // namespace scanloom::store
