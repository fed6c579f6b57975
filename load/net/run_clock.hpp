#pragma once

#include "load/core/micros.hpp"

#include <chrono>

namespace scanloom::load {

/// The time of a run for all its threads: microseconds since construction.
/// Threads: any.
class RunClock {
public:
    using Steady = std::chrono::steady_clock;

    [[nodiscard]] Micros now() const noexcept {
        return std::chrono::duration_cast<std::chrono::microseconds>(Steady::now() - begun_).count();
    }
    /// Converts a time for timers.
    [[nodiscard]] Steady::time_point at(Micros time) const noexcept { return begun_ + std::chrono::microseconds(time); }

private:
    Steady::time_point begun_ = Steady::now();
};

} // namespace scanloom::load
