#pragma once

#include <algorithm>

namespace scanloom::access {

/// A token bucket whose capacity is the amount of one second. It may be overdrawn.
/// All times are in seconds of a monotonic clock.
class Bucket {
public:
    /// Creates a full bucket.
    /// @param rate  amount per second; infinity means no limit
    Bucket(double rate, double now) noexcept : rate_(rate), left_(rate), seen_(now) {}

    /// Takes `amount` even if the bucket holds less.
    /// @return seconds until the missing amount has flowed in; 0 if nothing was missing
    [[nodiscard]] double take(double amount, double now) noexcept {
        refill(now);
        left_ -= amount;
        return left_ >= 0.0 ? 0.0 : -left_ / rate_;
    }

    /// Changes the rate from `now` on. The bucket keeps its content, up to the new capacity.
    void set_rate(double rate, double now) noexcept {
        refill(now);
        rate_ = rate;
        left_ = std::min(left_, rate_);
    }

    [[nodiscard]] double rate() const noexcept { return rate_; }

private:
    void refill(double now) noexcept {
        left_ = std::min(rate_, left_ + rate_ * std::max(now - seen_, 0.0));
        seen_ = now;
    }

    double rate_;
    double left_; // below 0: overdrawn
    double seen_;
};

} // namespace scanloom::access
