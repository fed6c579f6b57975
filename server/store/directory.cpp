#include "server/store/directory.hpp"

#include "server/store/failure.hpp"
#include "server/store/listing.hpp"
#include "server/store/synced_files.hpp"

#include <fmt/format.h>

#include <system_error>

#include <fcntl.h>
#include <unistd.h>

namespace scanloom::store {
namespace {

namespace fs = std::filesystem;

Error not_locked(const fs::path& directory, const Error& why) {
    if (why.code == Errc::kConflict) {
        return {why.code, fmt::format("the store {} is in use by another scanloom-server; stop it or name another "
                                      "directory",
                                      directory.native())};
    }
    return failure("the store {} cannot be used: {}", directory.native(), why.message);
}

/// Whether a program that does not take Scanloom's lock has RocksDB open here. The files of an open database must not
/// be changed.
bool rocksdb_is_open(const fs::path& directory) {
    const int file = ::open((directory / "LOCK").c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) return false;
    struct flock probe = {};
    probe.l_type = F_WRLCK;
    const bool held = ::fcntl(file, F_GETLK, &probe) == 0 && probe.l_type != F_UNLCK;
    ::close(file);
    return held;
}

} // namespace

Result<LockedDirectory> LockedDirectory::open(const fs::path& directory, Files files) {
    if (auto created = create_store_directory(directory); !created) return created.error();
    std::error_code ignored; // fails for another owner, or without permissions in the file system
    fs::permissions(directory, fs::perms::group_all | fs::perms::others_all, fs::perm_options::remove, ignored);
    auto lock = FileLock::alone(directory / kLockFile);
    if (!lock) return not_locked(directory, lock.error());
    auto locked = checked({directory, *std::move(lock)}, files);
    if (!locked) return locked;
    const auto listing = listing_of(directory);
    if (!listing) return listing.error();
    if (listing->has_current || listing->is_new) return locked;
    const auto mark = write_mark(directory / kNewFile, "A store is being made here; scanloom-server removes this file "
                                                       "as soon as it is there.");
    if (!mark) return mark.error();
    return locked;
}

Result<> LockedDirectory::holds_store() const { return remove_mark(path_ / kNewFile); }

Result<LockedDirectory> LockedDirectory::open_to_read(const fs::path& directory, Files files) {
    std::error_code problem;
    if (!fs::is_directory(directory, problem)) {
        return Error{Errc::kNotFound, fmt::format("there is no store {}; name its directory", directory.native())};
    }
    auto lock = FileLock::beside_others(directory / kLockFile); // a copy of a store may have no lock file
    if (!lock) return not_locked(directory, lock.error());
    return checked({directory, *std::move(lock)}, files);
}

Result<LockedDirectory> LockedDirectory::checked(LockedDirectory directory, Files files) {
    if (rocksdb_is_open(directory.path())) {
        return Error{Errc::kConflict,
                     fmt::format("the store {} is in use by another program; stop it or name another directory",
                                 directory.path().native())};
    }
    const auto listing = listing_of(directory.path());
    if (!listing) return listing.error();
    if (files == Files::kBeingMade) return directory;
    if (files == Files::kAny && !listing->is_unfinished) return directory;
    if (auto whole = check_listing(directory.path(), *listing); !whole) return whole.error();
    return directory;
}

std::uint64_t bytes_in(const fs::path& directory) {
    std::uint64_t bytes = 0;
    std::error_code problem; // files that appear or disappear meanwhile are not counted
    fs::directory_iterator file(directory, problem);
    for (; !problem && file != fs::directory_iterator(); file.increment(problem)) {
        std::error_code gone;
        const auto size = file->file_size(gone);
        if (!gone) bytes += size;
    }
    return bytes;
}

} // namespace scanloom::store
