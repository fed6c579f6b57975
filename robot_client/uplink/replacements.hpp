#pragma once

#include <chrono>
#include <cstddef>
#include <deque>

namespace scanloom::robot {

/// Distinguishes the two reasons for which a server ends a link with "the same robot connected again". Either an
/// earlier link of this program is the cause, whose hello arrived late over a stalled network; then retrying helps. Or
/// another program uses the same name; then both would replace each other forever.
class Replacements {
public:
    using Time = std::chrono::steady_clock::time_point;

    static constexpr std::size_t kMax = 3; ///< this many replacements within kWithin are too many
    static constexpr std::chrono::seconds kWithin{60};

    /// Records that a link was replaced.
    /// @return whether to connect again
    [[nodiscard]] bool may_pass(Time now) {
        while (!times_.empty() && times_.front() + kWithin <= now) times_.pop_front();
        times_.push_back(now);
        return times_.size() < kMax;
    }

private:
    std::deque<Time> times_; // at most kMax
};

} // namespace scanloom::robot
