#pragma once

#include "common/error/error.hpp"
#include "server/store/files.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

namespace scanloom::store {

/// Files by which Scanloom marks the directory of a store.
inline constexpr std::string_view kLockFile = "scanloom.lock";

/// Exists while a store is created, until it can be opened. What a killed process leaves next to it is not taken for a
/// store that lost files.
inline constexpr std::string_view kNewFile = "scanloom.new";

/// Exists while a store is repaired into the directory, until the store is complete; see UnfinishedStore.
inline constexpr std::string_view kUnfinishedFile = "scanloom.unfinished";

/// Whether a file with this name belongs to a store, as a file of Scanloom or of RocksDB.
[[nodiscard]] bool is_store_file(const std::string& name);

/// The store's directory, locked by this process during the object's lifetime. The lock is separate from RocksDB's,
/// because the directory is checked and an unfinished write is cut off before RocksDB opens it.
class LockedDirectory {
public:
    /// Which files open() and open_to_read() accept.
    enum class Files {
        kComplete,   ///< a store that lost no files
        kDamaged,    ///< a finished store, even if it lost files
        kUnfinished, ///< any files; for UnfinishedStore
    };

    /// Locks the directory and creates it if needed. A new directory is marked until finish_creation(), so that the
    /// files left by a killed process are not taken for a store that lost files.
    /// Errors: kConflict: another server or program uses it; kNotFound: it holds other files and no store;
    ///         kStoreFailed: it cannot be created or written, is not a directory, or holds a store that lost files or
    ///         is unfinished.
    [[nodiscard]] static Result<LockedDirectory> open(const std::filesystem::path& directory,
                                                      Files files = Files::kComplete);

    /// Removes the mark of a new directory, because a store has been opened in it.
    /// Errors: kStoreFailed: the disk cannot be written.
    [[nodiscard]] Result<> finish_creation() const;

    /// Locks the directory for reading. Creates and changes nothing, and admits other readers.
    /// Errors: kNotFound: there is no such directory, or it holds other files and no store; kConflict: a server or
    ///         another program uses it; kStoreFailed: it cannot be read, or holds a store that lost files or is
    ///         unfinished.
    [[nodiscard]] static Result<LockedDirectory> open_to_read(const std::filesystem::path& directory,
                                                              Files files = Files::kComplete);

    [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

private:
    [[nodiscard]] static Result<LockedDirectory> checked(LockedDirectory directory, Files files);

    LockedDirectory(std::filesystem::path path, FileLock lock) : path_(std::move(path)), lock_(std::move(lock)) {}

    std::filesystem::path path_;
    FileLock lock_;
};

} // namespace scanloom::store
