#pragma once

#include <algorithm>

namespace scanloom::limits {

/// Limits a rate. A caller takes any amount, and waits for the returned time before it takes more.
///
/// The bucket holds at most what flows in within `burst` seconds, and may be overdrawn: an amount above its content is
/// paid for by the wait after it.
/// All times are in seconds of a monotonic clock.
class TokenBucket {
public:
    /// Creates a full bucket.
    /// @param rate   amount per second; infinity: no limit
    /// @param burst  seconds of the rate that may be saved; 0: unused time is not saved, and the rate is finite
    /// @param now    seconds
    TokenBucket(double rate, double burst, double now) noexcept
        : rate_(rate), burst_(burst), left_(rate * burst), refilled_(now) {}

    /// Takes `amount`, even if the bucket holds less.
    /// @param amount  in the unit of the rate, 0 or more
    /// @param now     seconds; not before the times of earlier calls
    /// @return seconds until the missing amount has flowed in; 0 if the bucket held enough
    [[nodiscard]] double take(double amount, double now) noexcept {
        refill(now);
        left_ -= amount;
        return left_ >= 0.0 ? 0.0 : -left_ / rate_;
    }

    /// Changes the rate from `now` on. The bucket keeps its content, up to the new capacity.
    /// @param rate  amount per second; infinity: no limit
    /// @param now   seconds; not before the times of earlier calls
    void set_rate(double rate, double now) noexcept {
        refill(now);
        rate_ = rate;
        left_ = std::min(left_, capacity());
    }

    /// Returns the rate, amount per second.
    [[nodiscard]] double rate() const noexcept { return rate_; }

private:
    [[nodiscard]] double capacity() const noexcept { return rate_ * burst_; }

    void refill(double now) noexcept {
        left_ = std::min(capacity(), left_ + rate_ * std::max(now - refilled_, 0.0));
        refilled_ = now;
    }

    double rate_;
    double burst_;
    double left_; // below 0: overdrawn
    double refilled_;
};

} // namespace scanloom::limits
