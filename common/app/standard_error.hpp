#pragma once

#include <cstdint>
#include <mutex>
#include <string_view>

namespace scanloom {

/// Writes lines for people and never waits.
///
/// Drops a line that cannot be written at once, because the reader of the pipe is too slow or the terminal is stopped.
/// Before the next line that can be written it writes how many lines were dropped.
///
/// Errors: not reported.
/// Threads: any thread.
class StandardError {
public:
    explicit StandardError(int descriptor);
    ~StandardError();
    StandardError(const StandardError&) = delete;
    StandardError& operator=(const StandardError&) = delete;

    /// Writes a line with its line ending, or a partial line that will be overwritten.
    void write(std::string_view line);

    /// Returns whether this is a terminal that supports overwriting and colours.
    [[nodiscard]] bool is_terminal() const noexcept { return is_terminal_; }

private:
    [[nodiscard]] bool put(std::string_view text);

    const int given_;
    const int descriptor_;
    const bool is_terminal_;
    std::mutex mutex_;
    std::uint64_t dropped_ = 0;
    bool is_at_line_start_ = true;
};

/// Returns the standard error of this program, which takes all output for people while it runs.
[[nodiscard]] StandardError& standard_error();

} // namespace scanloom
