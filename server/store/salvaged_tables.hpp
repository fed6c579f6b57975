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

/// The tables and write-ahead logs of a damaged store, reduced to their intact content.
///
/// Each table is read by itself, because a bad block in one would hide what others contain. From a damaged table every
/// intact entry is taken (carve_table()), from write-ahead logs every complete write, including those after damage. If
/// the manifest is damaged or names tables that are missing, the existing tables are read without it. Parts that the
/// disk cannot read are skipped, 4 KiB at a time.
/// Threads: one.
class SalvagedTables {
public:
    /// A table file and the range of its keys.
    struct Table {
        std::filesystem::path file;
        std::string smallest;
        std::string largest;
    };

    /// Copies the store's tables and reads them.
    /// @param copy  directory to create; must not exist; the destructor deletes it. Tables are hard-linked where the
    ///              disk allows it: they never change, so they need not be copied.
    /// Errors: kStoreFailed: the copy cannot be made, a file cannot be opened (permissions), or nothing is readable.
    [[nodiscard]] static Result<std::unique_ptr<SalvagedTables>>
    open(const std::filesystem::path& store, const std::filesystem::path& copy, const StoreOptions& options);
    ~SalvagedTables();
    SalvagedTables(const SalvagedTables&) = delete;
    SalvagedTables& operator=(const SalvagedTables&) = delete;

    [[nodiscard]] const std::vector<Table>& all() const noexcept { return all_; }

    /// Whether a session that occurs in a table was removed later. May be unknown, and then false, if tables are
    /// missing or damaged.
    [[nodiscard]] bool is_removed(SessionId session) const;

    /// Returns sentences that describe what is damaged and what was taken from it.
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
    bool has_all_ = false;                  // whether it has every table that its manifest names
    std::set<SessionId> removed_;           // without all tables: removals found in the existing tables and logs
    std::vector<Table> all_;
    std::set<std::string> damaged_; // names of files of the store
    std::vector<std::string> notes_;
};

} // namespace scanloom::store
