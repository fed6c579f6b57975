#pragma once

#include "common/app/standard_error.hpp"

#include <chrono>
#include <string>
#include <string_view>

namespace scanloom {

/// Whole seconds, rounded up, as people write a time that is left: 0:07, 12:30, 1:02:03.
[[nodiscard]] std::string as_clock(double seconds);

/// What a program tells while it runs, on stderr. On a terminal the progress stays on one line that is written over;
/// elsewhere it is a plain line every few seconds. No colours, so there is nothing for NO_COLOR to switch off.
/// Nothing ever waits for a reader.
class Console {
public:
    explicit Console(StandardError& out) : out_(out) {}

    /// How often progress() is worth calling.
    [[nodiscard]] std::chrono::milliseconds progress_period() const;

    void progress(std::string_view text);
    void note(std::string_view text);
    /// Leaves the newest progress line standing.
    void finish();

private:
    StandardError& out_;
    bool line_is_open_ = false;
};

} // namespace scanloom
