#include "common/app/console.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace scanloom {

std::string as_clock(double seconds) {
    const auto whole = static_cast<std::int64_t>(std::clamp(std::ceil(seconds), 0.0, 1e9));
    if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
    return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

std::chrono::milliseconds Console::progress_period() const {
    return out_.is_terminal() ? std::chrono::milliseconds(200) : std::chrono::milliseconds(5000);
}

void Console::progress(std::string_view text) {
    line_is_open_ = out_.is_terminal();
    out_.write(line_is_open_ ? fmt::format("\r\x1b[K{}", text) : fmt::format("{}\n", text));
}

void Console::note(std::string_view text) {
    out_.write(fmt::format("{}{}\n", line_is_open_ ? "\r\x1b[K" : "", text));
    line_is_open_ = false;
}

void Console::finish() {
    if (line_is_open_) out_.write("\n");
    line_is_open_ = false;
}

} // namespace scanloom
