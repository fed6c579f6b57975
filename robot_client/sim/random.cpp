#include "robot_client/sim/random.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scanloom::robot {

double Random::uniform(double low, double high) {
    const double unit =
        static_cast<double>(engine_() >> 11) * 0x1p-53; // 53 bits: every double of that spacing in [0, 1)
    return low + (high - low) * unit;
}

// Box, Muller (1958), only one of the two values: so the engine holds the whole state.
double Random::gaussian(double sigma) {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform(0.0, 1.0)));
    return sigma * radius * std::cos(2.0 * std::numbers::pi * uniform(0.0, 1.0));
}

std::size_t Random::index(std::size_t count) {
    return std::min(static_cast<std::size_t>(uniform(0.0, static_cast<double>(count))), count - 1);
}

} // namespace scanloom::robot
