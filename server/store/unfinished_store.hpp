#pragma once

#include "common/error/error.hpp"
#include "server/store/files.hpp"
#include "server/store/scan_log.hpp"

#include <filesystem>
#include <memory>
#include <utility>

namespace scanloom::store {

/// The directory of a store that is being repaired or copied into. A mark file makes every attempt to open or check the
/// store fail until it is complete. The next repair or copy into the same directory removes what a killed one left
/// there.
/// Threads: one.
class UnfinishedStore {
public:
    /// Creates the directory, empty except for the mark.
    /// @param lost  directory for the logs that cannot become maps; other programs put no files there meanwhile; empty:
    ///              there will be none
    /// Errors: kConflict: there are files that nothing killed left, in it or in `lost`, or another process writes it;
    ///         kStoreFailed: the disk cannot be written.
    [[nodiscard]] static Result<UnfinishedStore> begin(const std::filesystem::path& directory,
                                                       const std::filesystem::path& lost);

    /// Opens the store for writing.
    /// Errors: those of open_rocksdb().
    [[nodiscard]] Result<std::unique_ptr<ScanLog>> open_log() const;

    /// Turns the directory into a store, durably.
    /// Pre: the store is not open.
    /// Errors: kStoreFailed: the store stays unfinished.
    [[nodiscard]] Result<> finish();

private:
    UnfinishedStore(std::filesystem::path directory, std::filesystem::path lost, FileLock lock)
        : directory_(std::move(directory)), lost_(std::move(lost)), lock_(std::move(lock)) {}

    std::filesystem::path directory_;
    std::filesystem::path lost_;
    FileLock lock_; // of the mark file
};

} // namespace scanloom::store
