#pragma once

#include <cstdint>
#include <random>

namespace scanloom::robot {

/// Random numbers that are the same on every machine. The C++ standard defines the engine; the distributions are
/// implemented here because those of <random> differ between libraries.
class Random {
public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}

    /// Returns a uniformly distributed number in [low, high).
    [[nodiscard]] double uniform(double low, double high);

    /// Returns a normally distributed number with mean 0.
    [[nodiscard]] double gaussian(double sigma);

    /// Returns a uniformly distributed index in 0 .. count - 1. Pre: count > 0.
    [[nodiscard]] std::size_t index(std::size_t count);

private:
    std::mt19937_64 engine_;
};

} // namespace scanloom::robot
