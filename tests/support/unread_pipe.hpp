#pragma once

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>

namespace scanloom::test {

/// A named pipe that is open for reading but is not read. A writer blocks when it is full.
class UnreadPipe {
public:
    explicit UnreadPipe(std::filesystem::path path) : path_(std::move(path)) {
        if (mkfifo(path_.c_str(), 0600) != 0) throw std::system_error(errno, std::generic_category(), "mkfifo");
        both_ends_ = open(path_.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
        if (both_ends_ < 0) throw std::system_error(errno, std::generic_category(), "open");
        fcntl(both_ends_, F_SETPIPE_SZ, 4096); // fills up soon
    }
    UnreadPipe(const UnreadPipe&) = delete;
    UnreadPipe& operator=(const UnreadPipe&) = delete;
    ~UnreadPipe() { close(both_ends_); }

    [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

    void fill() {
        const std::string page(4096, 'x');
        while (write(both_ends_, page.data(), page.size()) > 0) {
        }
    }

    /// Empties the pipe and returns its contents.
    [[nodiscard]] std::string empty() {
        std::string all;
        char bytes[4096];
        for (ssize_t count = 0; (count = read(both_ends_, bytes, sizeof bytes)) > 0;) {
            all.append(bytes, static_cast<std::size_t>(count));
        }
        return all;
    }

private:
    std::filesystem::path path_;
    int both_ends_ = -1;
};

} // namespace scanloom::test
