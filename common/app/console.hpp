#pragma once

#include "common/app/standard_error.hpp"

#include <chrono>
#include <string>
#include <string_view>

namespace scanloom {

/// Formats a remaining time in whole seconds, rounded up: 0:07, 12:30, 1:02:03.
[[nodiscard]] std::string as_clock(double seconds);

/// Prints the progress and the notes of a running program on stderr, and never waits for a reader.
///
/// On a terminal the progress is one line that is overwritten; elsewhere it is a plain line every few seconds. There
/// are no colours, so NO_COLOR has nothing to switch off.
class Console {
public:
    explicit Console(StandardError& out) : out_(out) {}

    /// Returns how often to call progress().
    [[nodiscard]] std::chrono::milliseconds progress_period() const;

    /// Replaces the progress line.
    void progress(std::string_view text);

    /// Prints a line in place of the progress line.
    void note(std::string_view text);

    /// Ends the progress line; its last text stays visible.
    void finish();

private:
    StandardError& out_;
    bool line_is_open_ = false;
};

} // namespace scanloom
