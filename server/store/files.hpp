#pragma once

#include "common/error/error.hpp"
#include "common/files/file_descriptor.hpp"

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <utility>
#include <vector>

/// Files and directories of the operating system: locks, listings, and changes that survive a power loss.
namespace scanloom::store {

/// A locked file that marks a directory as in use. The lock ends with this object, or with the process, however it
/// ends.
/// Source: flock(2).
class FileLock {
public:
    /// Locks the file exclusively; creates it if needed.
    /// Errors: kConflict: another process holds it; kStoreFailed: the file cannot be written or locked.
    [[nodiscard]] static Result<FileLock> exclusive(const std::filesystem::path& file);

    /// Takes a shared lock. Succeeds without a lock if there is no such file.
    /// Errors: kConflict: another process holds it exclusively; kStoreFailed: the file cannot be read or locked.
    [[nodiscard]] static Result<FileLock> shared(const std::filesystem::path& file);

private:
    [[nodiscard]] static Result<FileLock> locked(const std::filesystem::path& file, FileDescriptor opened,
                                                 int operation);

    explicit FileLock(FileDescriptor file) noexcept : file_(std::move(file)) {}

    FileDescriptor file_; // may be none
};

/// Keeps a file open to detect that its path no longer leads to it: the file was deleted, moved or replaced.
///
/// The file system does not reuse the inode of an open file, so equal device and inode mean the same file.
/// Threads: any, concurrently.
class HeldFile {
public:
    /// @param path  of a file or a directory; must stay valid relative to the working directory
    /// Errors: kNotFound: the path leads to no file; kStoreFailed: the file cannot be opened.
    [[nodiscard]] static Result<HeldFile> open(std::filesystem::path path);

    /// @return false if the path leads to no file or to another one. Costs two system calls.
    [[nodiscard]] bool is_in_place() const;

private:
    HeldFile(std::filesystem::path path, FileDescriptor file) : path_(std::move(path)), file_(std::move(file)) {}

    std::filesystem::path path_;
    FileDescriptor file_;
};

/// Makes creations, renames and removals in a directory durable. Without it, a power loss may undo them.
/// Errors: kStoreFailed, with the system's reason.
[[nodiscard]] Result<> sync_directory(const std::filesystem::path& directory);

/// Makes the contents of a file durable.
/// Errors: kStoreFailed, with the system's reason.
[[nodiscard]] Result<> sync_file(const std::filesystem::path& file);

/// Creates the store's directory and its parents as needed, durably.
/// Errors: kStoreFailed: it cannot be created, or is a file.
[[nodiscard]] Result<> create_store_directory(const std::filesystem::path& directory);

/// Writes a small file durably. The file marks a state by its existence; the sentence in it explains it to a reader.
/// Errors: kStoreFailed: the disk cannot be written.
[[nodiscard]] Result<> write_mark(const std::filesystem::path& file, std::string_view sentence);

/// Removes a mark durably. Succeeds if there is none.
/// Errors: kStoreFailed: the disk cannot be written.
[[nodiscard]] Result<> remove_mark(const std::filesystem::path& file);

/// Returns a directory's regular files, sorted by name.
/// @param extension  with its dot; empty: all files
[[nodiscard]] std::vector<std::filesystem::path> regular_files(const std::filesystem::path& directory,
                                                               std::string_view extension = {});

/// Returns the total size of the files in a directory, in bytes.
[[nodiscard]] std::uint64_t bytes_in(const std::filesystem::path& directory);

} // namespace scanloom::store
