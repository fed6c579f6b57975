#include "server/landmarks/median_filter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scanloom::landmarks {
namespace {

bool is_return(RangeMm range) { return range != kInvalidRange && range != kNoReturn; }

/// Pre  there are some. Reorders them.
RangeMm median_of(std::vector<RangeMm>& ranges) {
    const auto middle = ranges.begin() + static_cast<std::ptrdiff_t>(ranges.size() / 2);
    std::nth_element(ranges.begin(), middle, ranges.end());
    if (ranges.size() % 2 == 1) return *middle;
    const RangeMm below = *std::max_element(ranges.begin(), middle);
    return below + (*middle - below) / 2;
}

/// The beams of a window, from `begin` on for `count`, past the scan's end from its first beam on.
struct Window {
    std::size_t begin;
    std::size_t count;
};

Window window_around(std::size_t beam, std::size_t half, std::size_t beams, bool full_circle) {
    if (full_circle && 2 * half + 1 >= beams) return {0, beams};
    if (full_circle) return {(beam + beams - half) % beams, 2 * half + 1};
    const std::size_t begin = beam - std::min(beam, half);
    return {begin, std::min(beam + half + 1, beams) - begin};
}

} // namespace

Result<std::vector<RangeMm>> median_filtered(std::span<const RangeMm> ranges, std::size_t window, bool full_circle) {
    if (window % 2 == 0 || window > kMedianWindowMax) {
        return Error{Errc::kInvalidField,
                     fmt::format("window is {} beams; it must be odd and 1 .. {}", window, kMedianWindowMax)};
    }
    std::vector<RangeMm> filtered(ranges.begin(), ranges.end());
    std::vector<RangeMm> returns;
    for (std::size_t beam = 0; beam < ranges.size(); ++beam) {
        if (!is_return(ranges[beam])) continue;
        returns.clear();
        const Window around = window_around(beam, window / 2, ranges.size(), full_circle);
        for (std::size_t n = 0; n < around.count; ++n) {
            const RangeMm range = ranges[(around.begin + n) % ranges.size()];
            if (is_return(range)) returns.push_back(range);
        }
        filtered[beam] = median_of(returns);
    }
    return filtered;
}

bool is_full_circle(const BeamAngles& angles) {
    const std::size_t beams = beam_count(angles);
    if (beams < 3) return false;
    const double span = std::abs(beam_angle(angles, beams - 1) - beam_angle(angles, 0));
    const double step = span / static_cast<double>(beams - 1);
    return 2.0 * std::numbers::pi - span <= 2.5 * step;
}

} // namespace scanloom::landmarks
