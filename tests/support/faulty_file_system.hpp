#pragma once

#include <rocksdb/env.h>
#include <rocksdb/file_system.h>

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <string>

namespace scanloom {

/// RocksDB's file layer with a disk that fills up, fails to sync, loses power, or cannot read a sector.
///
/// Thread  any. A picture is taken between two operations, never in the middle of one.
class FaultyFileSystem final : public rocksdb::FileSystemWrapper {
public:
    FaultyFileSystem();

    /// The next sync of a write-ahead log fails, once; what was to be synced may or may not be on disk.
    void fail_next_log_sync();

    /// Writing fails as on a full disk, from now on or no more.
    void set_disk_full(bool full);

    /// What the disk is said to have free. Nothing: what it has.
    void set_free_bytes(std::optional<std::uint64_t> bytes);

    /// Reading byte `at` of files of this name fails from now on, and with it whatever else is read at once.
    void set_unreadable(const std::string& name, std::uint64_t at);

    /// Copies a directory as it would be found after a power cut now: of each file what was synced,
    /// then a part of what was written since, in which some pages may read as zeros.
    /// Names of files count as durable at once.
    void picture_of_power_cut(const std::filesystem::path& directory, const std::filesystem::path& destination,
                              std::mt19937& random);

    const char* Name() const override { return "FaultyFileSystem"; }
    rocksdb::IOStatus NewWritableFile(const std::string& name, const rocksdb::FileOptions& file_options,
                                      std::unique_ptr<rocksdb::FSWritableFile>* result,
                                      rocksdb::IODebugContext* debug) override;
    rocksdb::IOStatus NewRandomAccessFile(const std::string& name, const rocksdb::FileOptions& file_options,
                                          std::unique_ptr<rocksdb::FSRandomAccessFile>* result,
                                          rocksdb::IODebugContext* debug) override;
    rocksdb::IOStatus GetFreeSpace(const std::string& path, const rocksdb::IOOptions& options, std::uint64_t* bytes,
                                   rocksdb::IODebugContext* debug) override;
    rocksdb::IOStatus RenameFile(const std::string& from, const std::string& to, const rocksdb::IOOptions& options,
                                 rocksdb::IODebugContext* debug) override;
    rocksdb::IOStatus DeleteFile(const std::string& name, const rocksdb::IOOptions& options,
                                 rocksdb::IODebugContext* debug) override;

private:
    friend class FaultyFile;

    std::mutex mutex_;                                  // one operation at a time
    std::map<std::string, std::uint64_t> synced_bytes_; // by path, of files written since the start
    bool sync_fails_ = false;
    bool disk_full_ = false;
    std::optional<std::uint64_t> free_bytes_;
    std::map<std::string, std::uint64_t> unreadable_; // by name, without the directory
};

/// The file layer as a store takes it.
struct FaultyEnv {
    std::shared_ptr<FaultyFileSystem> files = std::make_shared<FaultyFileSystem>();
    std::unique_ptr<rocksdb::Env> env = rocksdb::NewCompositeEnv(files);
};

} // namespace scanloom
