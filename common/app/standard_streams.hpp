#pragma once

#include "common/files/file_descriptor.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>

namespace scanloom {

/// Opens /dev/null as standard input, output or error if the program was started with it closed. Otherwise the next
/// file or socket would get its number and receive what is printed. Call it before anything else in main().
/// Errors: throws std::system_error if /dev/null cannot be opened.
void open_missing_standard_streams();

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

    /// Writes a line with its line ending, or a partial line that will be overwritten.
    void write(std::string_view line);

    /// Returns whether this is a terminal that supports overwriting and colours.
    [[nodiscard]] bool is_terminal() const noexcept { return is_terminal_; }

private:
    [[nodiscard]] bool put(std::string_view text);

    const int given_;
    const FileDescriptor own_; // of the same file, opened again; none: write to given_
    const bool is_terminal_;
    std::mutex mutex_;
    std::uint64_t dropped_ = 0;
    bool is_at_line_start_ = true;
};

/// Returns the standard error of this program, which takes all output for people while it runs.
[[nodiscard]] StandardError& standard_error();

/// Formats a remaining time in whole seconds, rounded up: 0:07, 12:30, 1:02:03.
[[nodiscard]] std::string as_clock(double seconds);

/// Prints the progress and the notes of a running program on stderr, and never waits for a reader.
///
/// On a terminal the progress is overwritten; elsewhere it is a plain line every few seconds. There are no colours, so
/// NO_COLOR has nothing to switch off.
class Console {
public:
    explicit Console(StandardError& out) : out_(out) {}

    /// Returns how often to call progress().
    [[nodiscard]] std::chrono::milliseconds progress_period() const;

    /// Returns whether the progress is overwritten and may have several lines.
    [[nodiscard]] bool is_terminal() const { return out_.is_terminal(); }

    /// Replaces the progress.
    void progress(std::string_view text);

    /// Replaces the progress on a terminal; does nothing elsewhere.
    void passing(std::string_view text);

    /// Prints a line in place of the progress.
    void note(std::string_view text);

    /// Ends the progress; its last text stays visible.
    void finish();

    /// Removes the progress.
    void clear();

private:
    [[nodiscard]] std::string erasure() const;

    StandardError& out_;
    std::size_t lines_ = 0; ///< of the progress on the terminal; the cursor is in the last one
};

} // namespace scanloom
