#pragma once

#include <algorithm>
#include <chrono>
#include <optional>

namespace scanloom::robot {

/// When each scan of a source is due, so that it runs at `speed` times the pace of its stamps.
/// Speed 0 means at once. The first scan asked about is due immediately. Stamps may be any finite numbers: where the
/// clock of a recording was set, a step forward counts as kPauseMax at most, a step back of more than jitter as none.
class Pacer {
public:
    using Time = std::chrono::steady_clock::time_point;

    static constexpr double kPauseMax = 600.0; ///< seconds, of the source
    static constexpr double kJitterMax = 2.0;  ///< likewise
    static constexpr double kWaitMax = 1e9;    ///< seconds, of the steady clock: thirty years, and no overflow

    explicit Pacer(double speed) : speed_(speed) {}

    /// `stamp` in the source's seconds.
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
    double elapsed_ = 0.0; ///< seconds of the source since its first scan, pauses cut
};

} // namespace scanloom::robot
