#pragma once

#include "tests/fault/row.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <stdexcept>
#include <string_view>

/// The short form of a row: what `./scanloom fault ROW` runs.
namespace scanloom::fault {

/// Runs the row `name` as often as its short form asks for, with seed 1.
/// @param parts  it runs one of so many parts of that
/// @throws std::invalid_argument if there is no such row
[[nodiscard]] inline Outcome short_form_of(std::string_view name, std::uint64_t parts = 1) {
    const Row* row = find_row(name);
    if (row == nullptr) throw std::invalid_argument(fmt::format("there is no row {}", name));
    return row->run({.seed = 1, .count = row->count_short / parts});
}

/// Fails the test if scans were lost, stored twice or changed, or if nothing was tested.
inline void expect_passed(const Outcome& outcome) {
    for (const auto& sentence : outcome.failures) ADD_FAILURE() << sentence;
    EXPECT_EQ(outcome.lost, 0U);
    EXPECT_EQ(outcome.twice, 0U);
    EXPECT_TRUE(outcome.digest_equal);
    if (outcome.skipped) GTEST_SKIP() << *outcome.skipped;
    EXPECT_GT(outcome.acknowledged, 0U) << "no scan was acknowledged";
}

} // namespace scanloom::fault
