#pragma once

#include "common/app/standard_error.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace scanloom::load {

/// What is told while a run goes on: on a terminal rows that are written over, elsewhere plain lines. Nothing waits for
/// a reader.
class LiveDisplay {
public:
    explicit LiveDisplay(StandardError& out) : out_(out) {}

    [[nodiscard]] bool is_table() const { return out_.is_terminal(); }
    /// In place of the rows before.
    void show(const std::vector<std::string>& rows);
    /// A line that stays.
    void note(std::string_view text);
    /// A line that the next one takes the place of; nothing where lines cannot be written over.
    void passing(std::string_view text);
    /// Takes away what is written over.
    void clear();

private:
    StandardError& out_;
    std::size_t rows_ = 0; // that stand now, the cursor below them
};

} // namespace scanloom::load
