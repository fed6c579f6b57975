#include "common/app/standard_streams.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <system_error>

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

namespace scanloom {

void open_missing_standard_streams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (fcntl(stream, F_GETFD) >= 0) continue;
        // open() returns the lowest free number, and those below are in use.
        if (open("/dev/null", O_RDWR) != stream) {
            throw std::system_error(errno, std::generic_category(), "/dev/null cannot be opened");
        }
    }
}

namespace {

/// Opens a pipe or a terminal a second time, non-blocking. O_NONBLOCK belongs to the open file, which is shared with
/// the programs that passed the descriptor on, so it must not be set on theirs. If the file cannot be opened (a socket,
/// a terminal of another user), returns none; has_room() is then checked before each write.
FileDescriptor reopened(int descriptor) {
    struct stat status {};
    const bool may_wait = fstat(descriptor, &status) == 0 && (S_ISFIFO(status.st_mode) || isatty(descriptor) == 1);
    if (!may_wait) return {};
    const auto path = fmt::format("/proc/self/fd/{}", descriptor);
    return FileDescriptor(open(path.c_str(), O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
}

/// Returns whether PIPE_BUF bytes can be written without waiting, unless another program writes first.
bool has_room(int descriptor) {
    pollfd room{descriptor, POLLOUT, 0};
    return poll(&room, 1, 0) == 1 && (room.revents & POLLOUT) != 0;
}

bool is_capable_terminal(int descriptor) {
    const char* terminal = std::getenv("TERM");
    return isatty(descriptor) == 1 && terminal != nullptr && std::string_view(terminal) != "dumb";
}

} // namespace

StandardError::StandardError(int descriptor)
    : given_(descriptor), own_(reopened(descriptor)), is_terminal_(is_capable_terminal(descriptor)) {}

void StandardError::write(std::string_view line) {
    const std::lock_guard lock(mutex_);
    if (dropped_ > 0) {
        const auto what = dropped_ == 1 ? std::string("1 line was dropped because it was")
                                        : fmt::format("{} lines were dropped because they were", dropped_);
        const auto notice = fmt::format("{}{} not read\n", is_at_line_start_ ? "" : "\n", what);
        if (!put(notice)) {
            ++dropped_;
            return;
        }
        dropped_ = 0;
    }
    if (!put(line)) ++dropped_;
}

/// Returns false if not all of the text could be written at once.
bool StandardError::put(std::string_view text) {
    while (!text.empty()) {
        if (!own_ && !has_room(given_)) return false;
        const auto count =
            ::write(own_ ? own_.get() : given_, text.data(), std::min<std::size_t>(text.size(), PIPE_BUF));
        if (count <= 0) return false;
        is_at_line_start_ = text[static_cast<std::size_t>(count) - 1] == '\n';
        text.remove_prefix(static_cast<std::size_t>(count));
    }
    return true;
}

StandardError& standard_error() {
    static StandardError only(STDERR_FILENO);
    return only;
}

std::string as_clock(double seconds) {
    const auto whole = static_cast<std::int64_t>(std::clamp(std::ceil(seconds), 0.0, 1e9));
    if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
    return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

std::chrono::milliseconds Console::progress_period() const {
    return out_.is_terminal() ? std::chrono::milliseconds(200) : std::chrono::milliseconds(5000);
}

std::string Console::erasure() const {
    if (lines_ > 1) return fmt::format("\r\x1b[{}A\x1b[J", lines_ - 1); // up to the first line; erases to the end
    return lines_ == 1 ? "\r\x1b[K" : "";
}

void Console::progress(std::string_view text) {
    if (!is_terminal()) return out_.write(fmt::format("{}\n", text));
    out_.write(fmt::format("{}{}", lines_ == 0 ? "\r\x1b[K" : erasure(), text));
    lines_ = 1 + static_cast<std::size_t>(std::ranges::count(text, '\n'));
}

void Console::passing(std::string_view text) {
    if (is_terminal()) progress(text);
}

void Console::note(std::string_view text) {
    out_.write(fmt::format("{}{}\n", erasure(), text));
    lines_ = 0;
}

void Console::finish() {
    if (lines_ > 0) out_.write("\n");
    lines_ = 0;
}

void Console::clear() {
    if (lines_ > 0) out_.write(erasure());
    lines_ = 0;
}

} // namespace scanloom
