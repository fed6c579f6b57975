#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <span>

namespace scanloom::landmarks {

/// Returns the middle value; of an even count, the mean of the middle two. Reorders the values.
/// Precondition: there is at least one value; all are finite.
[[nodiscard]] inline double median(std::span<double> values) {
    assert(!values.empty());
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    if (values.size() % 2 == 1) return *middle;
    return 0.5 * (*std::max_element(values.begin(), middle) + *middle);
}

} // namespace scanloom::landmarks
