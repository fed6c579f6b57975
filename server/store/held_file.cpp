#include "server/store/held_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace scanloom::store {

Result<HeldFile> HeldFile::open(std::filesystem::path path) {
    const int descriptor = ::open(path.c_str(), O_PATH | O_CLOEXEC);
    if (descriptor < 0) {
        const int problem = errno;
        return Error{problem == ENOENT || problem == ENOTDIR ? Errc::kNotFound : Errc::kStoreFailed,
                     fmt::format("cannot open {}: {}", path.native(), std::system_category().message(problem))};
    }
    return HeldFile(std::move(path), descriptor);
}

HeldFile& HeldFile::operator=(HeldFile&& other) noexcept {
    std::swap(path_, other.path_);
    std::swap(descriptor_, other.descriptor_);
    return *this;
}

HeldFile::~HeldFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

bool HeldFile::is_in_place() const {
    struct stat held = {};
    struct stat found = {};
    if (::stat(path_.c_str(), &found) != 0) return errno != ENOENT && errno != ENOTDIR;
    return ::fstat(descriptor_, &held) != 0 || (held.st_dev == found.st_dev && held.st_ino == found.st_ino);
}

} // namespace scanloom::store
