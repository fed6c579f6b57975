#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>

namespace scanloom::session {

/// So many bytes a second, of whoever waits as long as it is told to; what was not read meanwhile is not made up for.
class ReadRate {
public:
    using Time = std::chrono::steady_clock::time_point;

    explicit ReadRate(double bytes_per_second) : bytes_per_second_(bytes_per_second) {}

    /// So many bytes have been read. @return when to go on.
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
