#pragma once

#include <algorithm>

namespace scanloom::access {

/// How much of something may pass in a time: a leaky bucket that holds what flows in a second.
/// Times   seconds of a clock that is never put back.
class Bucket {
public:
    /// Full at first. `rate` is what flows in a second; infinite: nothing is held back.
    Bucket(double rate, double now) noexcept : rate_(rate), left_(rate), seen_(now) {}

    /// Takes so much, whether it is there or not. @return seconds until it would have been.
    [[nodiscard]] double take(double amount, double now) noexcept {
        refill(now);
        left_ -= amount;
        return left_ >= 0.0 ? 0.0 : -left_ / rate_;
    }

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
    double left_; // below 0: owed
    double seen_;
};

} // namespace scanloom::access
