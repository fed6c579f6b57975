#pragma once

#include <chrono>
#include <cstdint>
#include <deque>

namespace scanloom::robot {

/// Measures how fast a count has recently increased. An earlier outage or slow start does not affect the result.
class RecentRate {
public:
    static constexpr std::chrono::duration<double> kWindow{10.0};

    /// @param now    time since any fixed moment; must not decrease
    /// @param count  the current count
    /// @return increase per second over the window, or since the first call if that is shorter
    [[nodiscard]] double update(std::chrono::duration<double> now, std::uint64_t count);

private:
    struct Sample {
        std::chrono::duration<double> at;
        std::uint64_t count;
    };

    std::deque<Sample> samples_; ///< the first one is the newest that is at least as old as the window, or the oldest
};

} // namespace scanloom::robot
