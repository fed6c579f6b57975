#pragma once

#include <chrono>
#include <cstddef>
#include <deque>

namespace scanloom::robot {

/// Tells two reasons apart for which a server ends a link with "the same robot connected again". One is an earlier link
/// of this program whose hello arrived late, over a network that stalls: it passes. The other is another program under
/// the same name, which would come back for ever, as this one would.
class Replacements {
public:
    using Time = std::chrono::steady_clock::time_point;

    static constexpr std::size_t kMax = 3; ///< so many of them within
    static constexpr std::chrono::seconds kWithin{60};

    /// A link was replaced. @return whether it may pass.
    [[nodiscard]] bool may_pass(Time now) {
        while (!times_.empty() && times_.front() + kWithin <= now) times_.pop_front();
        times_.push_back(now);
        return times_.size() < kMax;
    }

private:
    std::deque<Time> times_; // kMax at most
};

} // namespace scanloom::robot
