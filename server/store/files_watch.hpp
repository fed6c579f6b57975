#pragma once

#include "common/error/error.hpp"

#include <rocksdb/db.h>

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <utility>

namespace scanloom::store {

/// Keeps a file open to detect that its path no longer leads to it: the file was deleted, moved or replaced.
///
/// The file system does not reuse the inode of an open file, so equal device and inode mean the same file.
/// Threads: any, concurrently.
class HeldFile {
public:
    /// @param path  of a file or a directory; must stay valid relative to the working directory
    /// Errors: kNotFound: the path leads to no file; kStoreFailed: the file cannot be opened.
    [[nodiscard]] static Result<HeldFile> open(std::filesystem::path path);

    HeldFile(HeldFile&& other) noexcept
        : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)) {}
    HeldFile& operator=(HeldFile&& other) noexcept;
    ~HeldFile();

    /// @return false if the path leads to no file or to another one. Costs two system calls.
    [[nodiscard]] bool is_in_place() const;

private:
    HeldFile(std::filesystem::path path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {}

    std::filesystem::path path_;
    int descriptor_; // -1 after a move
};

/// Detects that the files of an open store were deleted, moved or replaced.
///
/// RocksDB does not detect this: it continues to write to deleted files, creates files by path, and deletes unknown
/// files by path, including those of a store that another server created in the same place.
/// Threads: any.
class FilesWatch {
public:
    /// @param database   of the store; must outlive this
    /// @param directory  of the store; has a lock file
    FilesWatch(rocksdb::DB& database, std::filesystem::path directory);

    /// Checks that the paths of the lock file and of the current write-ahead log lead to the files that this process
    /// has open. If not, stops RocksDB's background work and file deletions permanently. Files that cannot be examined,
    /// for example for lack of file descriptors, count as being in place.
    /// Errors: kStoreFailed: the store is not in its place, now or at an earlier check.
    [[nodiscard]] Result<> check();

private:
    [[nodiscard]] bool has_its_log();
    void give_up(const std::filesystem::path& missing);

    rocksdb::DB& database_;
    const std::filesystem::path directory_;
    std::mutex mutex_; // guards the members below
    std::optional<HeldFile> lock_;
    std::uint64_t log_number_ = 0;
    std::optional<HeldFile> log_;
    std::optional<Error> lost_;
};

} // namespace scanloom::store
