#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>

namespace scanloom::session {

/// Limits a read rate if the caller waits until the returned times. Unused time is not saved for later bursts.
class ReadRate {
public:
    using Time = std::chrono::steady_clock::time_point;

    explicit ReadRate(double bytes_per_second) : bytes_per_second_(bytes_per_second) {}

    /// Records a read of `bytes`. @return the time of the next read
    [[nodiscard]] Time after(std::size_t bytes, Time now) {
        const std::chrono::duration<double> worth(static_cast<double>(bytes) / bytes_per_second_);
        due_ = std::max(due_, now) + std::chrono::duration_cast<Time::duration>(worth);
        return due_;
    }

private:
    const double bytes_per_second_;
    Time due_{};
};

} // namespace scanloom::session
