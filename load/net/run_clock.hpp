#pragma once

#include "load/core/micros.hpp"

#include <chrono>

namespace scanloom::load {

/// One time for all threads of a run: microseconds since this was made.
/// Thread  any.
class RunClock {
public:
    using Steady = std::chrono::steady_clock;

    [[nodiscard]] Micros now() const noexcept {
        return std::chrono::duration_cast<std::chrono::microseconds>(Steady::now() - begun_).count();
    }
    /// For timers.
    [[nodiscard]] Steady::time_point at(Micros time) const noexcept { return begun_ + std::chrono::microseconds(time); }

private:
    Steady::time_point begun_ = Steady::now();
};

} // namespace scanloom::load
