#pragma once

#include <algorithm>
#include <chrono>
#include <optional>

namespace scanloom::robot {

/// When each scan of a source is due, so that it runs at `speed` times the pace of its stamps.
/// Speed 0 means at once. The first scan asked about is due immediately. Stamps may be any finite numbers: a gap of
/// more than kGapMax counts as that.
class Pacer {
public:
    using Time = std::chrono::steady_clock::time_point;

    static constexpr double kGapMax = 1e9; ///< seconds, of the steady clock: thirty years, and no overflow

    explicit Pacer(double speed) : speed_(speed) {}

    /// `stamp` in the source's seconds.
    [[nodiscard]] Time due(double stamp, Time now) {
        if (speed_ <= 0.0) return now;
        if (!start_) start_ = Start{stamp, now};
        const std::chrono::duration<double> since_start{
            std::clamp((stamp - start_->stamp) / speed_, -kGapMax, kGapMax)};
        return start_->time + std::chrono::duration_cast<Time::duration>(since_start);
    }

private:
    struct Start {
        double stamp = 0.0;
        Time time;
    };

    double speed_;
    std::optional<Start> start_;
};

} // namespace scanloom::robot
