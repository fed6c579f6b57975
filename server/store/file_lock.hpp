#pragma once

#include "common/error/error.hpp"

#include <filesystem>
#include <utility>

namespace scanloom::store {

/// A file that says, by being locked, that a directory is in use: for as long as this lives, and no longer than the
/// process, however it ends.
/// Source  flock(2).
class FileLock {
public:
    /// For one process alone. Creates the file if need be.
    /// Errors  kConflict: another holds it; kStoreFailed: the file cannot be written or locked.
    [[nodiscard]] static Result<FileLock> alone(const std::filesystem::path& file);

    /// Beside others that do the same. Where there is no such file there is nothing to hold.
    /// Errors  as above, for reading.
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
