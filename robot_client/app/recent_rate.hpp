#pragma once

#include <chrono>
#include <cstdint>
#include <deque>

namespace scanloom::robot {

/// How fast a count rises, of late: an outage that is over, or a slow begin, says nothing of what is to come.
class RecentRate {
public:
    static constexpr std::chrono::duration<double> kWindow{10.0};

    /// @param now    since any moment, never less than before
    /// @param count  the one of now
    /// @return how much it rose in a second, over the window, or over what has passed since the first of these.
    [[nodiscard]] double update(std::chrono::duration<double> now, std::uint64_t count);

private:
    struct Sample {
        std::chrono::duration<double> at;
        std::uint64_t count;
    };

    std::deque<Sample> samples_; ///< the first is the newest of those as old as the window, or the oldest
};

} // namespace scanloom::robot
