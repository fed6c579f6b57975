#include "tests/fault/simulation_row.hpp"

#include "tests/fault/cases.hpp"
#include "tests/fault/simulation/story.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <iostream>

namespace scanloom::fault {
namespace {

/// Prints the events, for a reader who repeats one story.
void tell_aloud(double seconds, std::string_view what, std::uint64_t number) {
    std::cerr << fmt::format("{:12.6f} s  {}", seconds, what) << (number > 0 ? fmt::format(" {}\n", number) : "\n");
}

} // namespace

Outcome run_simulation_row(const Run& run) {
    spdlog::set_level(spdlog::level::off); // failures are expected
    constexpr std::size_t kAtOnce = 2;     // they share no state
    const auto listener = run.count == 1 ? simulation::World::Listener(tell_aloud) : nullptr;
    const auto tell = [&](std::uint64_t seed, std::uint64_t) {
        return simulation::tell({.seed = seed, .listener = listener}).outcome;
    };
    return run_cases(run, {.row = "simulation", .at_once = kAtOnce, .run = tell});
}

} // namespace scanloom::fault
