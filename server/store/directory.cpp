#include "server/store/directory.hpp"

#include "server/store/advice.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

namespace scanloom::store {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kLockFile = "scanloom.lock";

template <class... Args>
Error failure(fmt::format_string<Args...> text, Args&&... args) {
    return {Errc::kStoreFailed, fmt::format(text, std::forward<Args>(args)...)};
}

std::string last_system_error() { return std::system_category().message(errno); }

/// Without this a power cut soon after creation could take the whole new directory along.
Result<> sync_directory(const fs::path& directory) {
    const int file = ::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (file < 0) return failure("cannot open the directory {}: {}", directory.native(), last_system_error());
    const bool synced = ::fsync(file) == 0;
    const std::string problem = synced ? "" : last_system_error();
    ::close(file);
    if (!synced) return failure("cannot sync the directory {}: {}", directory.native(), problem);
    return {};
}

Result<> create(const fs::path& directory) {
    std::error_code problem;
    const auto kind = fs::status(directory, problem).type();
    if (kind == fs::file_type::directory) return {};
    if (kind != fs::file_type::not_found && kind != fs::file_type::none) {
        return failure("the store {} is not a directory; name a directory of its own", directory.native());
    }
    fs::create_directories(directory, problem);
    if (problem) return failure("cannot create the store {}: {}", directory.native(), problem.message());
    for (auto made = fs::absolute(directory).lexically_normal(); made.has_relative_path(); made = made.parent_path()) {
        // All of them may be new; the upmost ones may be ones we cannot open, and those are not.
        if (::access(made.parent_path().c_str(), R_OK) != 0) break;
        if (auto synced = sync_directory(made.parent_path()); !synced) return synced;
    }
    return {};
}

Error not_locked(const fs::path& directory, const Error& why) {
    if (why.code == Errc::kConflict) {
        return {why.code, fmt::format("the store {} is in use by another scanloom-server; stop it or name another "
                                      "directory",
                                      directory.native())};
    }
    return failure("the store {} cannot be used: {}", directory.native(), why.message);
}

/// Whether a program without a lock of ours has RocksDB open here: its files must not be mended below it.
bool rocksdb_is_open(const fs::path& directory) {
    const int file = ::open((directory / "LOCK").c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) return false;
    struct flock probe = {};
    probe.l_type = F_WRLCK;
    const bool held = ::fcntl(file, F_GETLK, &probe) == 0 && probe.l_type != F_UNLCK;
    ::close(file);
    return held;
}

/// RocksDB takes a directory without CURRENT for an empty one, and removes table files no manifest
/// knows. So a store that lost files is recognised before RocksDB sees it.
Result<> check_files(const fs::path& directory) {
    bool tables = false;
    bool write_ahead_logs = false;
    std::string foreign;
    std::error_code problem;
    fs::directory_iterator file(directory, problem);
    for (; !problem && file != fs::directory_iterator(); file.increment(problem)) {
        const std::string name = file->path().filename().native();
        const std::string extension = file->path().extension().native();
        if (extension == ".sst")
            tables = true;
        else if (extension == ".log")
            write_ahead_logs = true;
        else if (name != kLockFile && name != "lost+found" && name != "CURRENT" && name != "IDENTITY" &&
                 name != "LOCK" && !name.starts_with("LOG") && !name.starts_with("MANIFEST-") &&
                 !name.starts_with("OPTIONS-") && extension != ".dbtmp") {
            foreign = name;
        }
    }
    if (problem) return failure("cannot list the store {}: {}", directory.native(), problem.message());
    const bool has_current = fs::exists(directory / "CURRENT", problem);
    if (!has_current && (tables || write_ahead_logs)) {
        return failure("the store {} is damaged: its file CURRENT is missing; {}", directory.native(), kBringBack);
    }
    if (!has_current && !foreign.empty()) {
        return failure("the directory {} holds other files ({}) and no store; name a directory of its own",
                       directory.native(), foreign);
    }
    if (tables && !write_ahead_logs) {
        return failure("the store {} is damaged: its write-ahead log (*.log) is missing; {}", directory.native(),
                       kBringBack);
    }
    return {};
}

} // namespace

Result<LockedDirectory> LockedDirectory::open(const fs::path& directory) {
    if (auto created = create(directory); !created) return created.error();
    auto lock = FileLock::alone(directory / kLockFile);
    if (!lock) return not_locked(directory, lock.error());
    return checked({directory, *std::move(lock)}, Files::kAll);
}

Result<LockedDirectory> LockedDirectory::open_to_read(const fs::path& directory, Files files) {
    std::error_code problem;
    if (!fs::is_directory(directory, problem)) {
        return Error{Errc::kNotFound, fmt::format("there is no store {}; name its directory", directory.native())};
    }
    auto lock = FileLock::beside_others(directory / kLockFile); // a copy of a store may come without
    if (!lock) return not_locked(directory, lock.error());
    return checked({directory, *std::move(lock)}, files);
}

Result<LockedDirectory> LockedDirectory::checked(LockedDirectory directory, Files files) {
    if (rocksdb_is_open(directory.path())) {
        return Error{Errc::kConflict,
                     fmt::format("the store {} is in use by another program; stop it or name another directory",
                                 directory.path().native())};
    }
    if (files == Files::kAny) return directory;
    if (auto checked = check_files(directory.path()); !checked) return checked.error();
    return directory;
}

std::uint64_t bytes_in(const fs::path& directory) {
    std::uint64_t bytes = 0;
    std::error_code problem; // files come and go meanwhile: those are not counted
    fs::directory_iterator file(directory, problem);
    for (; !problem && file != fs::directory_iterator(); file.increment(problem)) {
        std::error_code gone;
        const auto size = file->file_size(gone);
        if (!gone) bytes += size;
    }
    return bytes;
}

} // namespace scanloom::store
