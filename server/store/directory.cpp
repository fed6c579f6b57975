#include "server/store/directory.hpp"

#include "server/store/store_error.hpp"

#include <fmt/format.h>

#include <system_error>

#include <fcntl.h>

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
    const FileDescriptor file(::open((directory / "LOCK").c_str(), O_RDONLY | O_CLOEXEC));
    struct flock probe = {};
    probe.l_type = F_WRLCK;
    return file && ::fcntl(file.get(), F_GETLK, &probe) == 0 && probe.l_type != F_UNLCK;
}

/// What the file names in a directory show about the store in it.
struct Listing {
    bool has_current = false;          ///< without it, RocksDB sees no store
    bool has_tables = false;           ///< *.sst
    bool has_write_ahead_logs = false; ///< *.log
    bool is_new = false;               ///< kNewFile exists
    bool is_unfinished = false;        ///< kUnfinishedFile exists
    std::string trace;                 ///< name of another file that RocksDB creates; empty: none
    std::string foreign;               ///< name of a file that belongs to no store; empty: none
};

/// Files that do not show whether there is a store. *.dbtmp is left by checks of whether the disk can be written.
bool is_neutral(const std::string& name) {
    return name == kLockFile || name == "lost+found" || name == "LOCK" || name.ends_with(".dbtmp");
}

/// Files that RocksDB creates before CURRENT, or in addition to it.
bool is_trace(const std::string& name) {
    return name == "IDENTITY" || name.starts_with("LOG") || name.starts_with("MANIFEST-") ||
           name.starts_with("OPTIONS-");
}

void note(Listing& listing, const std::string& name) {
    if (name == "CURRENT")
        listing.has_current = true;
    else if (name == kNewFile)
        listing.is_new = true;
    else if (name == kUnfinishedFile)
        listing.is_unfinished = true;
    else if (name.ends_with(".sst"))
        listing.has_tables = true;
    else if (name.ends_with(".log"))
        listing.has_write_ahead_logs = true;
    else if (is_neutral(name))
        return;
    else if (is_trace(name))
        listing.trace = name;
    else
        listing.foreign = name;
}

/// Errors: kStoreFailed: the directory cannot be listed.
Result<Listing> listing_of(const fs::path& directory) {
    Listing listing;
    std::error_code problem;
    fs::directory_iterator file(directory, problem);
    for (; !problem && file != fs::directory_iterator(); file.increment(problem)) {
        note(listing, file->path().filename().native());
    }
    if (problem) return failure("cannot list the store {}: {}", directory.native(), problem.message());
    return listing;
}

/// Detects a store that lost files before RocksDB opens it: RocksDB takes a directory without CURRENT for an empty one
/// and removes table files that no manifest names.
/// Errors: kStoreFailed: the store lost files or is unfinished; kNotFound: there are other files, and no store.
Result<> check_listing(const fs::path& directory, const Listing& listing) {
    if (listing.is_unfinished) {
        return failure(
            "the store {} is unfinished: --repair or --copy has not finished writing it; wait for it, or run it again",
            directory.native());
    }
    if (!listing.has_current && (listing.has_tables || listing.has_write_ahead_logs)) {
        return failure("the store {} is damaged: its file CURRENT is missing; {}", directory.native(), kRecover);
    }
    if (!listing.has_current && !listing.foreign.empty()) {
        return Error{Errc::kNotFound, fmt::format("the directory {} holds other files ({}) and no store; name a "
                                                  "directory of its own",
                                                  directory.native(), listing.foreign)};
    }
    if (!listing.has_current && !listing.trace.empty() && !listing.is_new) {
        return failure("the store {} has lost all its entries: only files such as {} are left; restore it from a "
                       "backup (--restore) into another directory, or delete these files to start with an empty store",
                       directory.native(), listing.trace);
    }
    const bool has_been_open = listing.has_tables || (listing.has_current && !listing.is_new);
    if (has_been_open && !listing.has_write_ahead_logs) {
        return failure("the store {} is damaged: its write-ahead log (*.log) is missing; {}", directory.native(),
                       kRecover);
    }
    return {};
}

} // namespace

bool is_store_file(const std::string& name) {
    Listing listing;
    note(listing, name);
    return listing.foreign.empty() && name != "lost+found";
}

Result<LockedDirectory> LockedDirectory::open(const fs::path& directory, Files files) {
    if (auto created = create_store_directory(directory); !created) return created.error();
    std::error_code ignored; // fails for another owner, or without permissions in the file system
    fs::permissions(directory, fs::perms::group_all | fs::perms::others_all, fs::perm_options::remove, ignored);
    auto lock = FileLock::exclusive(directory / kLockFile);
    if (!lock) return not_locked(directory, lock.error());
    auto locked = checked({directory, *std::move(lock)}, files);
    if (!locked) return locked;
    const auto listing = listing_of(directory);
    if (!listing) return listing.error();
    if (listing->has_current || listing->is_new) return locked;
    const auto mark = write_mark(directory / kNewFile, "A store is being created here; scanloom-server removes this "
                                                       "file when the store is complete.");
    if (!mark) return mark.error();
    return locked;
}

Result<> LockedDirectory::finish_creation() const { return remove_mark(path_ / kNewFile); }

Result<LockedDirectory> LockedDirectory::open_to_read(const fs::path& directory, Files files) {
    std::error_code problem;
    if (!fs::is_directory(directory, problem)) {
        return Error{Errc::kNotFound, fmt::format("there is no store {}; name its directory", directory.native())};
    }
    auto lock = FileLock::shared(directory / kLockFile); // a copy of a store may have no lock file
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
    if (files == Files::kUnfinished) return directory;
    if (files == Files::kDamaged && !listing->is_unfinished) return directory;
    if (auto whole = check_listing(directory.path(), *listing); !whole) return whole.error();
    return directory;
}

} // namespace scanloom::store
