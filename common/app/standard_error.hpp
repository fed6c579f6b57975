#pragma once

#include <cstdint>
#include <mutex>
#include <string_view>

namespace scanloom {

/// Writes lines for people and never waits: what cannot be written at once, because nobody empties the pipe or the
/// terminal stands still, is dropped. The next line that can be written comes after one that tells how many were lost.
///
/// Errors  none that anybody could be told.
/// Thread  any.
class StandardError {
public:
    explicit StandardError(int descriptor);
    ~StandardError();
    StandardError(const StandardError&) = delete;
    StandardError& operator=(const StandardError&) = delete;

    /// One line with its ending, or a piece of one that is going to be written over.
    void write(std::string_view line);

    /// True for a terminal on which lines can be written over and coloured.
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

/// The standard error of this program; everything it says while it runs goes here.
[[nodiscard]] StandardError& standard_error();

} // namespace scanloom
