#include "server/store/file_lock.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace scanloom::store {
namespace {

Error lock_failure(const char* what, const std::filesystem::path& file, int error) {
    return {Errc::kStoreFailed,
            fmt::format("cannot {} {}: {}", what, file.native(), std::system_category().message(error))};
}

} // namespace

Result<FileLock> FileLock::alone(const std::filesystem::path& file) {
    const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (descriptor < 0) return lock_failure("write", file, errno);
    return locked(file, descriptor, LOCK_EX);
}

Result<FileLock> FileLock::beside_others(const std::filesystem::path& file) {
    const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0 && errno == ENOENT) return FileLock(-1);
    if (descriptor < 0) return lock_failure("read", file, errno);
    return locked(file, descriptor, LOCK_SH);
}

Result<FileLock> FileLock::locked(const std::filesystem::path& file, int descriptor, int operation) {
    FileLock held(descriptor);
    if (::flock(descriptor, operation | LOCK_NB) == 0) return held;
    const int error = errno;
    if (error == EWOULDBLOCK)
        return Error{Errc::kConflict, fmt::format("{} is held by another process", file.native())};
    return lock_failure("lock", file, error);
}

FileLock::~FileLock() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

} // namespace scanloom::store
