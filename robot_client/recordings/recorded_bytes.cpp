#include "robot_client/recordings/recorded_bytes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

namespace scanloom::robot {
namespace {

constexpr std::size_t kFileWindowBytes = std::size_t{256} << 10;

} // namespace

BytesOfFile::BytesOfFile(std::string path, FileDescriptor file, std::uint64_t size)
    : path_(std::move(path)), file_(std::move(file)), size_(size) {}

Result<std::unique_ptr<BytesOfFile>> BytesOfFile::open(const std::filesystem::path& path) {
    const auto failure = [&](std::string_view what) {
        return Error{Errc::kNotFound, fmt::format("{}: {}", path.string(), what)};
    };
    std::error_code failed;
    if (!std::filesystem::exists(path, failed)) return failure("no such file; check the path");
    if (!std::filesystem::is_regular_file(path, failed)) return failure("not a regular file; name a recording");
    FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
    if (!file) return failure(fmt::format("cannot be opened: {}", std::strerror(errno)));
    const auto size = std::filesystem::file_size(path, failed);
    if (failed) return failure(fmt::format("cannot be read: {}", failed.message()));
    return std::unique_ptr<BytesOfFile>(new BytesOfFile(path.string(), std::move(file), size));
}

Result<> BytesOfFile::fill(std::string& bytes, std::uint64_t offset, std::size_t count) const {
    const std::uint64_t available = offset < size_ ? size_ - offset : 0;
    bytes.resize(std::min<std::uint64_t>(count, available));
    std::size_t have = 0;
    while (have < bytes.size()) {
        const ssize_t got =
            ::pread(file_.get(), bytes.data() + have, bytes.size() - have, static_cast<off_t>(offset + have));
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) {
            return Error{Errc::kMalformed, fmt::format("{}: reading failed at byte {}: {}; copy the file to another "
                                                       "disk and try again",
                                                       path_, offset + have, std::strerror(errno))};
        }
        if (got == 0) break; // the file has become shorter
        have += static_cast<std::size_t>(got);
    }
    bytes.resize(have);
    return {};
}

Result<std::string_view> BytesOfFile::read(std::uint64_t offset, std::size_t count) {
    const auto is_in_window = [&] {
        return offset >= window_begin_ && offset - window_begin_ <= window_.size() &&
               window_.size() - (offset - window_begin_) >= count;
    };
    if (!is_in_window()) {
        window_begin_ = offset;
        if (auto ok = fill(window_, offset, std::max(count, kFileWindowBytes)); !ok) return ok.error();
    }
    return std::string_view(window_).substr(offset - window_begin_, count);
}

Result<std::string_view> BytesOfFile::peek(std::uint64_t offset, std::size_t count) {
    if (offset >= window_begin_ && offset - window_begin_ < window_.size()) {
        const auto rest = std::string_view(window_).substr(offset - window_begin_);
        if (rest.size() >= count) return rest.substr(0, count);
    }
    if (auto ok = fill(peeked_, offset, count); !ok) return ok.error();
    return std::string_view(peeked_);
}

} // namespace scanloom::robot
