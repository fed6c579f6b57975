#pragma once

#include "tests/fault/command.hpp"
#include "tests/fault/outcome.hpp"

#include <cstdint>
#include <functional>
#include <span>
#include <string_view>

namespace scanloom::fault {

/// The parameters of a row's run.
struct Run {
    std::uint64_t seed = 1;  ///< seed of all random choices
    std::uint64_t count = 1; ///< in the row's unit, see Row::counts
    bool is_long = false;    ///< the long form, if it differs by more than a larger count
    Command server{};        ///< the program under test, if the row runs one
    Command robot{};         ///< likewise, if robots are programs
    /// Called from time to time with the part of `count` that is done.
    std::function<void(std::uint64_t)> on_progress = [](std::uint64_t) {};
};

/// One row of docs/reliability.md: a kind of fault, and the guarantees that must hold after it.
struct Row {
    std::string_view name;
    std::string_view counts; ///< the unit of `count`
    std::uint64_t count_short = 0;
    std::uint64_t count_long = 0;
    std::string_view about;
    Outcome (*run)(const Run& run) = nullptr;
};

/// Returns all rows, in the order of docs/reliability.md.
[[nodiscard]] std::span<const Row> rows();
[[nodiscard]] const Row* find_row(std::string_view name);

} // namespace scanloom::fault
