#include "server/store/files.hpp"

#include "server/store/store_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace scanloom::store {
namespace {

namespace fs = std::filesystem;

std::string text_of(int error) { return std::system_category().message(error); }

Result<> sync(const fs::path& path, int flags, std::string_view what) {
    const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | flags));
    if (!file) return failure("cannot open the {} {}: {}", what, path.native(), text_of(errno));
    if (::fsync(file.get()) == 0) return {};
    return failure("cannot sync the {} {}: {}", what, path.native(), text_of(errno));
}

} // namespace

Result<FileLock> FileLock::exclusive(const fs::path& file) {
    FileDescriptor opened(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644));
    if (!opened) return failure("cannot write {}: {}", file.native(), text_of(errno));
    return locked(file, std::move(opened), LOCK_EX);
}

Result<FileLock> FileLock::shared(const fs::path& file) {
    FileDescriptor opened(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
    if (!opened && errno == ENOENT) return FileLock(std::move(opened));
    if (!opened) return failure("cannot read {}: {}", file.native(), text_of(errno));
    return locked(file, std::move(opened), LOCK_SH);
}

Result<FileLock> FileLock::locked(const fs::path& file, FileDescriptor opened, int operation) {
    if (::flock(opened.get(), operation | LOCK_NB) == 0) return FileLock(std::move(opened));
    if (errno == EWOULDBLOCK)
        return Error{Errc::kConflict, fmt::format("{} is held by another process", file.native())};
    return failure("cannot lock {}: {}", file.native(), text_of(errno));
}

Result<HeldFile> HeldFile::open(fs::path path) {
    FileDescriptor file(::open(path.c_str(), O_PATH | O_CLOEXEC));
    if (file) return HeldFile(std::move(path), std::move(file));
    const bool is_missing = errno == ENOENT || errno == ENOTDIR;
    return Error{is_missing ? Errc::kNotFound : Errc::kStoreFailed,
                 fmt::format("cannot open {}: {}", path.native(), text_of(errno))};
}

bool HeldFile::is_in_place() const {
    struct stat held = {};
    struct stat found = {};
    if (::stat(path_.c_str(), &found) != 0) return errno != ENOENT && errno != ENOTDIR;
    return ::fstat(file_.get(), &held) != 0 || (held.st_dev == found.st_dev && held.st_ino == found.st_ino);
}

Result<> sync_directory(const fs::path& directory) { return sync(directory, O_DIRECTORY, "directory"); }

Result<> sync_file(const fs::path& file) { return sync(file, 0, "file"); }

Result<> create_store_directory(const fs::path& directory) {
    std::error_code problem;
    const auto kind = fs::status(directory, problem).type();
    if (kind == fs::file_type::directory) return {};
    if (kind != fs::file_type::not_found && kind != fs::file_type::none) {
        return failure("the store {} is not a directory; name a directory of its own", directory.native());
    }
    fs::create_directories(directory, problem);
    if (problem) return failure("cannot create the store {}: {}", directory.native(), problem.message());
    for (auto made = fs::absolute(directory).lexically_normal(); made.has_relative_path(); made = made.parent_path()) {
        // All of these directories may be new, except those near the root that this process cannot open.
        if (::access(made.parent_path().c_str(), R_OK) != 0) break;
        if (auto synced = sync_directory(made.parent_path()); !synced) return synced;
    }
    return {};
}

Result<> write_mark(const fs::path& file, std::string_view sentence) {
    std::ofstream out(file, std::ios::binary);
    out << sentence << '\n';
    out.close();
    if (!out) return failure("cannot write {}; make room on its disk", file.native());
    if (auto synced = sync_file(file); !synced) return synced;
    return sync_directory(file.parent_path());
}

Result<> remove_mark(const fs::path& file) {
    std::error_code problem;
    if (!fs::remove(file, problem) && !problem) return {}; // it did not exist
    if (problem) return failure("cannot remove {}: {}", file.native(), problem.message());
    return sync_directory(file.parent_path());
}

std::vector<fs::path> regular_files(const fs::path& directory, std::string_view extension) {
    std::vector<fs::path> found;
    std::error_code none;
    for (fs::directory_iterator file(directory, none); !none && file != fs::directory_iterator();
         file.increment(none)) {
        if (!extension.empty() && file->path().extension() != extension) continue;
        if (file->is_regular_file(none)) found.push_back(file->path());
    }
    std::ranges::sort(found);
    return found;
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
