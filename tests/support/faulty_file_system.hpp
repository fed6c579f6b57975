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

/// RocksDB's file layer on a simulated disk that fills up, fails to sync, loses power, or cannot read a sector.
///
/// Thread  any. A copy of the disk is made between two operations, never during one.
class FaultyFileSystem final : public rocksdb::FileSystemWrapper {
public:
    FaultyFileSystem();

    /// Lets the next sync of a write-ahead log fail once. The data of that sync may or may not be on the disk.
    void fail_next_log_sync();

    /// Lets writes fail as on a full disk, until this is called with false.
    void set_disk_full(bool full);

    /// Sets the free space that the disk reports. nullopt: the real value.
    void set_free_bytes(std::optional<std::uint64_t> bytes);

    /// Lets reads of byte `at` fail from now on in files of this name. A read of a range that contains the byte fails
    /// as a whole.
    void set_unreadable(const std::string& name, std::uint64_t at);

    /// Copies a directory in the state in which a power cut at this moment would leave it: of each file the synced
    /// bytes, then a part of the bytes written since, in which some pages may read as zeros. File names count as
    /// durable at once.
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
    std::map<std::string, std::uint64_t> synced_bytes_; // by path, for files written since the start
    bool sync_fails_ = false;
    bool disk_full_ = false;
    std::optional<std::uint64_t> free_bytes_;
    std::map<std::string, std::uint64_t> unreadable_; // by name, without the directory
};

/// The file layer in the form that a store accepts.
struct FaultyEnv {
    std::shared_ptr<FaultyFileSystem> files = std::make_shared<FaultyFileSystem>();
    std::unique_ptr<rocksdb::Env> env = rocksdb::NewCompositeEnv(files);
};

} // namespace scanloom
