#pragma once

#include <cstdint>
#include <random>

namespace scanloom::robot {

/// Random numbers that are the same on every machine: the engine is fixed by the C++ standard, and the
/// distributions are made here because those of <random> differ between libraries.
class Random {
public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}

    /// Evenly spread over [low, high).
    [[nodiscard]] double uniform(double low, double high);

    /// Normally distributed around 0.
    [[nodiscard]] double gaussian(double sigma);

    /// Evenly spread over 0 .. count - 1. Pre: count > 0.
    [[nodiscard]] std::size_t index(std::size_t count);

private:
    std::mt19937_64 engine_;
};

} // namespace scanloom::robot
