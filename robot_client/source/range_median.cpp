#include "robot_client/source/range_median.hpp"

#include <algorithm>
#include <array>
#include <cassert>

namespace scanloom::robot {
namespace {

constexpr std::int32_t kGapsMax = 4; // as on the server: wider gaps were not observed

bool is_return(RangeMm range) { return range != kInvalidRange && range != kNoReturn; }

/// Returns the steps from each beam to the next, around the turn.
std::vector<std::int32_t> gaps_between(std::span<const std::int32_t> steps, std::int32_t steps_per_turn) {
    std::vector<std::int32_t> gaps(steps.size());
    for (std::size_t i = 0; i + 1 < steps.size(); ++i) gaps[i] = steps[i + 1] - steps[i];
    gaps.back() = steps.front() + steps_per_turn - steps.back();
    return gaps;
}

std::int32_t median_of(std::vector<std::int32_t> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

} // namespace

std::vector<RangeMm> median_filtered(std::span<const RangeMm> ranges, std::span<const std::int32_t> steps,
                                     std::int32_t steps_per_turn, int window) {
    assert(window % 2 == 1 && window >= 1 && window <= kMedianWindowMax);
    assert(ranges.size() == steps.size());
    std::vector<RangeMm> filtered(ranges.begin(), ranges.end());
    const std::size_t count = ranges.size();
    if (count < static_cast<std::size_t>(window)) return filtered;
    const auto gaps = gaps_between(steps, steps_per_turn);
    const std::int32_t gap_max = kGapsMax * median_of(gaps);
    /// Returns whether beam `i` and the next one are adjacent returns.
    const auto goes_on = [&](std::size_t i) {
        return is_return(ranges[i]) && is_return(ranges[(i + 1) % count]) && gaps[i] <= gap_max;
    };
    std::array<RangeMm, kMedianWindowMax> values;
    for (std::size_t i = 0; i < count; ++i) {
        std::size_t reach = 0;
        const auto half = static_cast<std::size_t>(window / 2);
        while (reach < half && goes_on((i + reach) % count) && goes_on((i + count - reach - 1) % count)) ++reach;
        const std::size_t size = 2 * reach + 1;
        for (std::size_t k = 0; k < size; ++k) values[k] = ranges[(i + count - reach + k) % count];
        const auto middle = values.begin() + static_cast<std::ptrdiff_t>(reach);
        std::nth_element(values.begin(), middle, values.begin() + static_cast<std::ptrdiff_t>(size));
        filtered[i] = *middle;
    }
    return filtered;
}

} // namespace scanloom::robot
