#pragma once

#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

/// Counts and durations in messages for people.
namespace scanloom::robot {

/// Formats a count with its noun: "1 turn", "2 turns".
[[nodiscard]] inline std::string counted(std::uint64_t count, std::string_view noun) {
    return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

/// Converts a duration to seconds.
[[nodiscard]] inline double seconds(std::chrono::milliseconds duration) {
    return std::chrono::duration<double>(duration).count();
}

} // namespace scanloom::robot
