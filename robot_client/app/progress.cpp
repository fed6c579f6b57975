#include "robot_client/app/progress.hpp"

#include <fmt/format.h>

#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace scanloom::robot {
namespace {

std::string as_clock(double seconds) {
    const auto whole = static_cast<std::int64_t>(std::min(std::ceil(seconds), 1e9));
    if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
    return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

} // namespace

std::string progress_text(const UplinkStatus& status, std::optional<std::uint64_t> total,
                          std::chrono::duration<double> elapsed) {
    const double rate =
        elapsed.count() > 0.0 ? static_cast<double>(status.acknowledged - status.resumed_after) / elapsed.count() : 0.0;
    std::string text = total ? fmt::format("{} of {} scans stored", status.acknowledged, *total)
                             : fmt::format("{} scans stored", status.acknowledged);
    text += fmt::format(", {:.0f} a second", rate);
    if (total && rate > 0.0 && *total >= status.acknowledged) {
        text += fmt::format(", {} left", as_clock(static_cast<double>(*total - status.acknowledged) / rate));
    }
    if (!status.is_linked) text += fmt::format(", not connected, {} waiting", status.last - status.acknowledged);
    return text;
}

bool Console::stderr_is_terminal() {
    const char* terminal = std::getenv("TERM");
    return isatty(STDERR_FILENO) == 1 && terminal != nullptr && std::string_view(terminal) != "dumb";
}

std::chrono::milliseconds Console::progress_period() const {
    return is_terminal_ ? std::chrono::milliseconds(200) : std::chrono::milliseconds(5000);
}

void Console::progress(std::string_view text) {
    if (!is_terminal_) {
        fmt::print(stderr, "{}\n", text);
        return;
    }
    fmt::print(stderr, "\r\x1b[K{}", text);
    std::fflush(stderr);
    line_is_open_ = true;
}

void Console::note(std::string_view text) {
    fmt::print(stderr, "{}{}\n", line_is_open_ ? "\r\x1b[K" : "", text);
    line_is_open_ = false;
}

void Console::finish() {
    if (line_is_open_) fmt::print(stderr, "\n");
    line_is_open_ = false;
}

} // namespace scanloom::robot
