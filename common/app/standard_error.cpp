#include "common/app/standard_error.hpp"

#include <fmt/format.h>

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstdlib>

namespace scanloom {
namespace {

/// Opens a pipe or a terminal a second time, non-blocking. O_NONBLOCK belongs to the open file, which is shared with
/// the programs that passed the descriptor on, so it must not be set on theirs. If the file cannot be opened (a socket,
/// a terminal of another user), returns `descriptor`; has_room() is then checked before each write.
int opened_anew(int descriptor) {
    struct stat status {};
    const bool may_wait = fstat(descriptor, &status) == 0 && (S_ISFIFO(status.st_mode) || isatty(descriptor) == 1);
    if (!may_wait) return descriptor;
    const auto path = fmt::format("/proc/self/fd/{}", descriptor);
    const int own = open(path.c_str(), O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    return own >= 0 ? own : descriptor;
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
    : given_(descriptor), descriptor_(opened_anew(descriptor)), is_terminal_(is_capable_terminal(descriptor)) {}

StandardError::~StandardError() {
    if (descriptor_ != given_) close(descriptor_);
}

void StandardError::write(std::string_view line) {
    const std::lock_guard lock(mutex_);
    if (dropped_ > 0) {
        const auto notice = fmt::format("{}{} dropped: nobody read them\n", is_at_line_start_ ? "" : "\n",
                                        dropped_ == 1 ? "1 line was" : fmt::format("{} lines were", dropped_));
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
        if (descriptor_ == given_ && !has_room(given_)) return false;
        const auto count = ::write(descriptor_, text.data(), std::min<std::size_t>(text.size(), PIPE_BUF));
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

} // namespace scanloom
