#include "tests/fault/unsynced_files.hpp"

#include <rocksdb/file_system.h>

#include <string>

namespace scanloom::fault {
namespace {

using rocksdb::IODebugContext;
using rocksdb::IOOptions;
using rocksdb::IOStatus;

class UnsyncedFile final : public rocksdb::FSWritableFileOwnerWrapper {
public:
    explicit UnsyncedFile(std::unique_ptr<rocksdb::FSWritableFile> file)
        : FSWritableFileOwnerWrapper(std::move(file)) {}

    IOStatus Sync(const IOOptions& options, IODebugContext* debug) override { return target()->Flush(options, debug); }
    IOStatus Fsync(const IOOptions& options, IODebugContext* debug) override { return target()->Flush(options, debug); }
};

class UnsyncedFileSystem final : public rocksdb::FileSystemWrapper {
public:
    UnsyncedFileSystem() : FileSystemWrapper(rocksdb::FileSystem::Default()) {}

    const char* Name() const override { return "UnsyncedFileSystem"; }

    IOStatus NewWritableFile(const std::string& name, const rocksdb::FileOptions& options,
                             std::unique_ptr<rocksdb::FSWritableFile>* result, IODebugContext* debug) override {
        auto status = target()->NewWritableFile(name, options, result, debug);
        if (status.ok()) *result = std::make_unique<UnsyncedFile>(std::move(*result));
        return status;
    }
};

} // namespace

std::unique_ptr<rocksdb::Env> unsynced_files() {
    return rocksdb::NewCompositeEnv(std::make_shared<UnsyncedFileSystem>());
}

} // namespace scanloom::fault
