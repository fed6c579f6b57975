#pragma once

#include "common/app/standard_streams.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace scanloom::load {

/// Shows the progress of a run: rows that are overwritten on a terminal, plain lines elsewhere. Writing never waits for
/// a reader.
class LiveDisplay {
public:
    explicit LiveDisplay(StandardError& out) : out_(out) {}

    [[nodiscard]] bool is_table() const { return out_.is_terminal(); }
    /// Replaces the previous rows.
    void show(const std::vector<std::string>& rows);
    /// Writes a line that stays.
    void note(std::string_view text);
    /// Writes a line that the next output replaces; does nothing if the output is not a terminal.
    void passing(std::string_view text);
    /// Removes the rows that would be overwritten.
    void clear();

private:
    StandardError& out_;
    std::size_t rows_ = 0; // currently on the screen, above the cursor
};

} // namespace scanloom::load
