#pragma once

#include "common/error/error.hpp"
#include "server/store/file_lock.hpp"

#include <cstdint>
#include <filesystem>
#include <utility>

namespace scanloom::store {

/// The store's directory, held by this process alone for as long as this lives.
/// A lock of our own beside RocksDB's, as the directory is looked at and mended before RocksDB opens it.
class LockedDirectory {
public:
    /// What its files have to be.
    enum class Files {
        kAll,       ///< those of a store that lost none
        kAny,       ///< of a store that is finished, whatever it lost
        kBeingMade, ///< whatever is there: for whoever makes an UnfinishedStore
    };

    /// Creates the directory if need be. A new one is marked as such until holds_store(), so that what a kill leaves of
    /// it is not taken for a store that lost its files.
    /// Errors  kConflict: in use by another server or program; kStoreFailed: it cannot be created, is no directory,
    ///         cannot be written, holds other files than a store, or a store that lost files or is unfinished.
    [[nodiscard]] static Result<LockedDirectory> open(const std::filesystem::path& directory,
                                                      Files files = Files::kAll);

    /// Says that a store has been opened in it. Errors  kStoreFailed: it cannot be written.
    [[nodiscard]] Result<> holds_store() const;

    /// The same for who only reads: makes and changes nothing, and keeps no other reader out.
    /// Errors  kNotFound: there is no such directory; else as above.
    [[nodiscard]] static Result<LockedDirectory> open_to_read(const std::filesystem::path& directory,
                                                              Files files = Files::kAll);

    [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

private:
    [[nodiscard]] static Result<LockedDirectory> checked(LockedDirectory directory, Files files);

    LockedDirectory(std::filesystem::path path, FileLock lock) : path_(std::move(path)), lock_(std::move(lock)) {}

    std::filesystem::path path_;
    FileLock lock_;
};

/// Bytes of all files in a directory.
[[nodiscard]] std::uint64_t bytes_in(const std::filesystem::path& directory);

} // namespace scanloom::store
