#include "tests/support/faulty_file_system.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <utility>

namespace scanloom {

using rocksdb::IODebugContext;
using rocksdb::IOOptions;
using rocksdb::IOStatus;
using rocksdb::Slice;

namespace {

/// A file with one byte that cannot be read.
class FileWithBadSector final : public rocksdb::FSRandomAccessFileOwnerWrapper {
public:
    FileWithBadSector(std::unique_ptr<rocksdb::FSRandomAccessFile> file, std::uint64_t at)
        : FSRandomAccessFileOwnerWrapper(std::move(file)), at_(at) {}

    IOStatus Read(std::uint64_t offset, std::size_t bytes, const IOOptions& options, Slice* result, char* scratch,
                  IODebugContext* debug) const override {
        if (offset <= at_ && at_ < offset + bytes) return IOStatus::IOError("Input/output error");
        return FSRandomAccessFileOwnerWrapper::Read(offset, bytes, options, result, scratch, debug);
    }

private:
    const std::uint64_t at_;
};

} // namespace

/// A file open for writing through a FaultyFileSystem.
class FaultyFile final : public rocksdb::FSWritableFileOwnerWrapper {
public:
    FaultyFile(std::unique_ptr<rocksdb::FSWritableFile> file, FaultyFileSystem& files, std::string name)
        : FSWritableFileOwnerWrapper(std::move(file)), files_(files), name_(std::move(name)) {}

    IOStatus Append(const Slice& data, const IOOptions& options, IODebugContext* debug) override {
        const std::lock_guard lock(files_.mutex_);
        if (files_.disk_full_) return IOStatus::NoSpace("No space left on device", name_);
        auto status = target()->Append(data, options, debug);
        if (status.ok()) written_bytes_ += data.size();
        return status;
    }
    IOStatus Append(const Slice& data, const IOOptions& options, const rocksdb::DataVerificationInfo&,
                    IODebugContext* debug) override {
        return Append(data, options, debug);
    }
    IOStatus Sync(const IOOptions& options, IODebugContext* debug) override {
        const std::lock_guard lock(files_.mutex_);
        if (files_.sync_fails_ && name_.ends_with(".log")) {
            files_.sync_fails_ = false;
            return IOStatus::IOError("Input/output error while syncing", name_);
        }
        auto status = target()->Sync(options, debug);
        if (status.ok()) files_.synced_bytes_[name_] = written_bytes_;
        return status;
    }
    IOStatus Fsync(const IOOptions& options, IODebugContext* debug) override { return Sync(options, debug); }

private:
    FaultyFileSystem& files_;
    const std::string name_;
    std::uint64_t written_bytes_ = 0;
};

namespace {

constexpr std::size_t kPageBytes = 4096;

/// Returns the remainder of a file after a power cut when only its first `synced` bytes were synced.
std::string torn(std::string bytes, std::size_t synced, std::mt19937& random) {
    if (bytes.size() <= synced) return bytes;
    bytes.resize(synced + random() % (bytes.size() - synced + 1));
    if (random() % 2 == 0) return bytes;
    for (std::size_t page = synced; page < bytes.size(); page += kPageBytes - page % kPageBytes) {
        if (random() % 2 == 0) continue;
        const std::size_t end = std::min(bytes.size(), page + kPageBytes - page % kPageBytes);
        std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(page), bytes.begin() + static_cast<std::ptrdiff_t>(end),
                  '\0');
    }
    return bytes;
}

} // namespace

FaultyFileSystem::FaultyFileSystem() : FileSystemWrapper(rocksdb::FileSystem::Default()) {}

void FaultyFileSystem::fail_next_log_sync() {
    const std::lock_guard lock(mutex_);
    sync_fails_ = true;
}

void FaultyFileSystem::set_disk_full(bool full) {
    const std::lock_guard lock(mutex_);
    disk_full_ = full;
}

void FaultyFileSystem::picture_of_power_cut(const std::filesystem::path& directory,
                                            const std::filesystem::path& destination, std::mt19937& random) {
    const std::lock_guard lock(mutex_);
    std::filesystem::create_directories(destination);
    for (const auto& file : std::filesystem::directory_iterator(directory)) {
        std::ifstream in(file.path(), std::ios::binary);
        std::string bytes{std::istreambuf_iterator<char>(in), {}};
        const auto synced = synced_bytes_.find(file.path().native());
        if (synced != synced_bytes_.end()) bytes = torn(std::move(bytes), synced->second, random);
        std::ofstream(destination / file.path().filename(), std::ios::binary) << bytes;
    }
}

IOStatus FaultyFileSystem::NewWritableFile(const std::string& name, const rocksdb::FileOptions& file_options,
                                           std::unique_ptr<rocksdb::FSWritableFile>* result, IODebugContext* debug) {
    const std::lock_guard lock(mutex_);
    if (disk_full_) return IOStatus::NoSpace("No space left on device", name);
    auto status = target()->NewWritableFile(name, file_options, result, debug);
    if (!status.ok()) return status;
    synced_bytes_[name] = 0;
    *result = std::make_unique<FaultyFile>(std::move(*result), *this, name);
    return status;
}

void FaultyFileSystem::set_unreadable(const std::string& name, std::uint64_t at) {
    const std::lock_guard lock(mutex_);
    unreadable_[name] = at;
}

IOStatus FaultyFileSystem::NewRandomAccessFile(const std::string& name, const rocksdb::FileOptions& file_options,
                                               std::unique_ptr<rocksdb::FSRandomAccessFile>* result,
                                               IODebugContext* debug) {
    auto status = FileSystemWrapper::NewRandomAccessFile(name, file_options, result, debug);
    if (!status.ok()) return status;
    const std::lock_guard lock(mutex_);
    const auto unreadable = unreadable_.find(std::filesystem::path(name).filename());
    if (unreadable != unreadable_.end()) {
        *result = std::make_unique<FileWithBadSector>(std::move(*result), unreadable->second);
    }
    return status;
}

void FaultyFileSystem::set_free_bytes(std::optional<std::uint64_t> bytes) {
    const std::lock_guard lock(mutex_);
    free_bytes_ = bytes;
}

rocksdb::IOStatus FaultyFileSystem::GetFreeSpace(const std::string& path, const rocksdb::IOOptions& options,
                                                 std::uint64_t* bytes, rocksdb::IODebugContext* debug) {
    const std::lock_guard lock(mutex_);
    if (!free_bytes_) return FileSystemWrapper::GetFreeSpace(path, options, bytes, debug);
    *bytes = *free_bytes_;
    return rocksdb::IOStatus::OK();
}

IOStatus FaultyFileSystem::RenameFile(const std::string& from, const std::string& to, const IOOptions& options,
                                      IODebugContext* debug) {
    const std::lock_guard lock(mutex_);
    auto status = target()->RenameFile(from, to, options, debug);
    if (!status.ok()) return status;
    if (auto moved = synced_bytes_.extract(from)) {
        synced_bytes_.erase(to);
        moved.key() = to;
        synced_bytes_.insert(std::move(moved));
    }
    return status;
}

IOStatus FaultyFileSystem::DeleteFile(const std::string& name, const IOOptions& options, IODebugContext* debug) {
    const std::lock_guard lock(mutex_);
    auto status = target()->DeleteFile(name, options, debug);
    if (status.ok()) synced_bytes_.erase(name);
    return status;
}

} // namespace scanloom
