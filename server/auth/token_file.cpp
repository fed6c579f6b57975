#include "server/auth/token_file.hpp"

#include "common/files/file_descriptor.hpp"
#include "server/auth/token_text.hpp"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <string>
#include <system_error>

namespace scanloom::auth {
namespace {

constexpr std::size_t kFileBytesMax = std::size_t{4} << 20;

Error unreadable(const std::filesystem::path& path, int why) {
    return {Errc::kNotFound,
            fmt::format("{}: the tokens cannot be read: {}", path.string(), std::generic_category().message(why))};
}

/// Checks the open file, not the path, so that the file cannot be replaced between the check and the read.
Result<> check_file(const std::filesystem::path& path, int descriptor) {
    struct stat facts {};
    if (::fstat(descriptor, &facts) != 0) return unreadable(path, errno);
    if (!S_ISREG(facts.st_mode)) {
        return Error{Errc::kNotFound, fmt::format("{}: this is no file; name the file with the tokens", path.string())};
    }
    if ((facts.st_mode & (S_IWGRP | S_IWOTH)) != 0) {
        return Error{Errc::kInvalidField,
                     fmt::format("{0}: users other than its owner can write to it and add tokens; chmod go-w {0}",
                                 path.string())};
    }
    if (static_cast<std::size_t>(facts.st_size) <= kFileBytesMax) return {};
    return Error{Errc::kTooLarge, fmt::format("{}: it has {} bytes; tokens take {} at most", path.string(),
                                              facts.st_size, kFileBytesMax)};
}

Result<std::string> content_of(const std::filesystem::path& path) {
    const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (!file) return unreadable(path, errno);
    if (auto fit = check_file(path, file.get()); !fit) return fit.error();
    std::string content(kFileBytesMax, '\0');
    std::size_t size = 0;
    while (size < content.size()) {
        const auto got = ::read(file.get(), content.data() + size, content.size() - size);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return unreadable(path, errno);
        if (got == 0) break;
        size += static_cast<std::size_t>(got);
    }
    content.resize(size);
    return content;
}

} // namespace

Result<TokenSet> read_tokens(const std::filesystem::path& path) {
    const auto content = content_of(path);
    if (!content) return content.error();
    auto tokens = parse_tokens(*content);
    if (!tokens) return prefixed(path.string() + ":", tokens.error());
    return tokens;
}

} // namespace scanloom::auth
