#include "load/core/schedule.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace scanloom::load {

Schedule::Schedule(std::uint32_t robots, double rate)
    : robots_(robots), step_(static_cast<double>(kSecond) / (rate * static_cast<double>(robots))) {
    assert(robots > 0 && rate > 0.0);
}

std::uint64_t Schedule::scans_within(double duration_s, double rate) noexcept {
    const double scans = std::ceil(duration_s * rate - 1e-6); // 0.3 s at 10 Hz are three, despite rounding errors
    return static_cast<std::uint64_t>(std::max(scans, 1.0));
}

} // namespace scanloom::load
