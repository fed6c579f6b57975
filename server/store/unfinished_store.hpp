#pragma once

#include "common/error/error.hpp"
#include "server/store/file_lock.hpp"
#include "server/store/scan_log.hpp"

#include <filesystem>
#include <memory>
#include <utility>

namespace scanloom::store {

/// The directory of a store that is being repaired, which is none before all of it is there: a file in it says so, and
/// whoever opens or checks it is told. What a killed repair left there is removed by the next into the same directory.
/// Thread  one.
class UnfinishedStore {
public:
    /// Makes the directory, which is empty then but for the mark.
    /// @param lost  where what cannot be woven is going to be; no other files are or come there meanwhile.
    /// Errors  kConflict: there are other files than a killed repair's, in it or in `lost`, or another process repairs
    ///         into it; kStoreFailed: the disk cannot take it.
    [[nodiscard]] static Result<UnfinishedStore> begin(const std::filesystem::path& directory,
                                                       const std::filesystem::path& lost);

    /// For a copy of the old store, on the same disk. It is gone with the next repair, whatever becomes of this one.
    [[nodiscard]] std::filesystem::path salvage() const;

    /// To write it. Errors  as of open_rocksdb().
    [[nodiscard]] Result<std::unique_ptr<ScanLog>> open_log() const;

    /// Makes a store of it, durably.
    /// Pre     nobody has it open.
    /// Errors  kStoreFailed: it stays unfinished.
    [[nodiscard]] Result<> finish();

private:
    UnfinishedStore(std::filesystem::path directory, std::filesystem::path lost, FileLock lock)
        : directory_(std::move(directory)), lost_(std::move(lost)), lock_(std::move(lock)) {}

    std::filesystem::path directory_;
    std::filesystem::path lost_;
    FileLock lock_; // of the mark
};

} // namespace scanloom::store
