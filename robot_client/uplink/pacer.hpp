#pragma once

#include <algorithm>
#include <chrono>
#include <optional>

namespace scanloom::robot {

/// Computes when each scan of a source is due so that the source runs at `speed` times the pace of its stamps. Speed 0
/// means immediately. The first scan is due immediately. Stamps may be any finite numbers: if the clock of a recording
/// was set, a step forward counts as at most kPauseMax, and a step back of more than kJitterMax counts as zero.
class Pacer {
public:
    using Time = std::chrono::steady_clock::time_point;

    static constexpr double kPauseMax = 600.0; ///< seconds of the source's time
    static constexpr double kJitterMax = 2.0;  ///< seconds of the source's time
    static constexpr double kWaitMax = 1e9;    ///< seconds of the steady clock: thirty years, no overflow

    explicit Pacer(double speed) : speed_(speed) {}

    /// @param stamp  seconds of the source's time
    [[nodiscard]] Time due(double stamp, Time now) {
        if (speed_ <= 0.0) return now;
        if (!start_) start_ = now;
        const double step = stamp - last_stamp_.value_or(stamp);
        if (step >= -kJitterMax) elapsed_ += std::min(step, kPauseMax);
        last_stamp_ = stamp;
        const std::chrono::duration<double> since_start{std::min(elapsed_ / speed_, kWaitMax)};
        return *start_ + std::chrono::duration_cast<Time::duration>(since_start);
    }

private:
    double speed_;
    std::optional<Time> start_;
    std::optional<double> last_stamp_;
    double elapsed_ = 0.0; ///< seconds of the source since its first scan, with long pauses shortened
};

} // namespace scanloom::robot
