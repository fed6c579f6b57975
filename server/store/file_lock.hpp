#pragma once

#include "common/error/error.hpp"

#include <filesystem>
#include <utility>

namespace scanloom::store {

/// A locked file that marks a directory as in use. The lock ends with this object, or with the process, however it
/// ends.
/// Source: flock(2).
class FileLock {
public:
    /// Locks the file exclusively; creates it if needed.
    /// Errors: kConflict: another process holds it; kStoreFailed: the file cannot be written or locked.
    [[nodiscard]] static Result<FileLock> alone(const std::filesystem::path& file);

    /// Takes a shared lock. Succeeds without a lock if there is no such file.
    /// Errors: kConflict: another process holds it exclusively; kStoreFailed: the file cannot be read or locked.
    [[nodiscard]] static Result<FileLock> beside_others(const std::filesystem::path& file);

    FileLock(FileLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
    FileLock& operator=(FileLock&&) = delete;
    ~FileLock();

private:
    [[nodiscard]] static Result<FileLock> locked(const std::filesystem::path& file, int descriptor, int operation);

    explicit FileLock(int descriptor) noexcept : descriptor_(descriptor) {}

    int descriptor_; // or -1
};

} // namespace scanloom::store
