#include "robot_client/ros/stamp_gaps.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace scanloom::robot {
namespace {

constexpr std::size_t kIntervalsMin = 8; // that make one of them usual
constexpr std::size_t kIntervalsMax = 15;
constexpr std::uint64_t kGapsOfNewRate = 8;
constexpr double kGapFrom = 1.75; // usual intervals
constexpr RosTime kPauseFrom = 10'000'000'000;

} // namespace

RosTime StampGaps::usual() const {
    std::vector<RosTime> sorted(intervals_.begin(), intervals_.end());
    const auto middle = sorted.begin() + std::ssize(sorted) / 2;
    std::ranges::nth_element(sorted, middle);
    return *middle;
}

std::uint64_t StampGaps::add(RosTime stamp) {
    const RosTime step = stamp - std::exchange(newest_, stamp);
    if (!std::exchange(is_begun_, true) || step <= 0 || step > kPauseFrom) return 0;
    if (intervals_.size() >= kIntervalsMin) {
        const double times = static_cast<double>(step) / static_cast<double>(usual());
        if (times > kGapFrom && ++gaps_in_a_row_ < kGapsOfNewRate) {
            const auto missing = static_cast<std::uint64_t>(std::llround(times)) - 1;
            ++gaps_;
            missing_ += missing;
            return missing;
        }
        if (times > kGapFrom) intervals_.clear();
        gaps_in_a_row_ = 0;
    }
    intervals_.push_back(step);
    if (intervals_.size() > kIntervalsMax) intervals_.pop_front();
    return 0;
}

} // namespace scanloom::robot
