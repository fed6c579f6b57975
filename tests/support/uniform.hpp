#pragma once

#include <random>

namespace scanloom::testing_support {

/// Returns a number of the uniform distribution over [low, high), in steps of 2^-32 of its width, equal on every
/// machine.
inline double uniform(std::mt19937& random, double low, double high) {
    return low + (high - low) * (static_cast<double>(random()) * 0x1p-32);
}

} // namespace scanloom::testing_support
