#pragma once

#include "tests/fault/command.hpp"
#include "tests/fault/outcome.hpp"

#include <cstdint>
#include <functional>
#include <span>
#include <string_view>

namespace scanloom::fault {

/// What a row is told.
struct Run {
    std::uint64_t seed = 1;  ///< all that is random comes from it
    std::uint64_t count = 1; ///< of what the row counts
    bool is_long = false;    ///< the long form, where it is more than a larger count
    Command server{};        ///< what is disturbed, where the row runs a program
    Command robot{};         ///< likewise, where robots are programs
    /// Hears, now and then, how much of `count` is done.
    std::function<void(std::uint64_t)> on_progress = [](std::uint64_t) {};
};

/// One row of docs/reliability.md: a kind of fault, and what has to hold after it.
struct Row {
    std::string_view name;
    std::string_view counts; ///< what `count` is of
    std::uint64_t count_short = 0;
    std::uint64_t count_long = 0;
    std::string_view about;
    Outcome (*run)(const Run& run) = nullptr;
};

/// All there are, as docs/reliability.md lists them.
[[nodiscard]] std::span<const Row> rows();
[[nodiscard]] const Row* find_row(std::string_view name);

} // namespace scanloom::fault
