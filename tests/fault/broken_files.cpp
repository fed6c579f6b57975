#include "tests/fault/broken_files.hpp"

#include <rocksdb/file_system.h>

#include <string>
#include <utility>

namespace scanloom::fault {
namespace {

using rocksdb::FileOptions;
using rocksdb::IODebugContext;
using rocksdb::IOOptions;
using rocksdb::IOStatus;

class UnsyncedFile final : public rocksdb::FSWritableFileOwnerWrapper {
public:
    using FSWritableFileOwnerWrapper::FSWritableFileOwnerWrapper;

    IOStatus Sync(const IOOptions& options, IODebugContext* debug) override { return target()->Flush(options, debug); }
    IOStatus Fsync(const IOOptions& options, IODebugContext* debug) override { return target()->Flush(options, debug); }
};

IOStatus trusted(const IOStatus& synced) {
    synced.PermitUncheckedError();
    return IOStatus::OK();
}

class TrustingFile final : public rocksdb::FSWritableFileOwnerWrapper {
public:
    using FSWritableFileOwnerWrapper::FSWritableFileOwnerWrapper;

    IOStatus Sync(const IOOptions& options, IODebugContext* debug) override {
        return trusted(target()->Sync(options, debug));
    }
    IOStatus Fsync(const IOOptions& options, IODebugContext* debug) override {
        return trusted(target()->Fsync(options, debug));
    }
    IOStatus RangeSync(std::uint64_t offset, std::uint64_t bytes, const IOOptions& options,
                       IODebugContext* debug) override {
        return trusted(target()->RangeSync(offset, bytes, options, debug));
    }
};

class TrustingDirectory final : public rocksdb::FSDirectoryWrapper {
public:
    using FSDirectoryWrapper::FSDirectoryWrapper;

    IOStatus Fsync(const IOOptions& options, IODebugContext* debug) override {
        return trusted(FSDirectoryWrapper::Fsync(options, debug));
    }
    IOStatus FsyncWithDirOptions(const IOOptions& options, IODebugContext* debug,
                                 const rocksdb::DirFsyncOptions& how) override {
        return trusted(FSDirectoryWrapper::FsyncWithDirOptions(options, debug, how));
    }
};

/// An environment whose new files are of the given kind.
template <class File>
class FileSystemOf : public rocksdb::FileSystemWrapper {
public:
    FileSystemOf() : FileSystemWrapper(rocksdb::FileSystem::Default()) {}

    const char* Name() const override { return "BrokenFileSystem"; }

    IOStatus NewWritableFile(const std::string& name, const FileOptions& options,
                             std::unique_ptr<rocksdb::FSWritableFile>* result, IODebugContext* debug) override {
        auto status = target()->NewWritableFile(name, options, result, debug);
        if (status.ok()) *result = std::make_unique<File>(std::move(*result));
        return status;
    }
};

class TrustingFileSystem final : public FileSystemOf<TrustingFile> {
public:
    IOStatus NewDirectory(const std::string& name, const IOOptions& options,
                          std::unique_ptr<rocksdb::FSDirectory>* result, IODebugContext* debug) override {
        auto status = target()->NewDirectory(name, options, result, debug);
        if (status.ok()) *result = std::make_unique<TrustingDirectory>(std::move(*result));
        return status;
    }
};

} // namespace

std::unique_ptr<rocksdb::Env> unsynced_files() {
    return rocksdb::NewCompositeEnv(std::make_shared<FileSystemOf<UnsyncedFile>>());
}

std::unique_ptr<rocksdb::Env> trusting_files() {
    return rocksdb::NewCompositeEnv(std::make_shared<TrustingFileSystem>());
}

} // namespace scanloom::fault
