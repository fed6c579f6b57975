#include "server/metrics/duration_histogram.hpp"

#include <algorithm>
#include <limits>

namespace scanloom::metrics {

void DurationHistogram::observe(std::chrono::nanoseconds took, std::uint64_t times) noexcept {
    const auto bound = std::ranges::lower_bound(
        kBounds, took, {}, [](std::uint32_t microseconds) { return std::chrono::microseconds(microseconds); });
    counts_[static_cast<std::size_t>(bound - kBounds.begin())].fetch_add(times, std::memory_order_relaxed);
    const auto positive = static_cast<std::uint64_t>(std::max(took, std::chrono::nanoseconds::zero()).count());
    nanoseconds_.fetch_add(positive * times, std::memory_order_relaxed);
}

prometheus::MetricFamily DurationHistogram::family() const {
    prometheus::ClientMetric metric;
    auto& histogram = metric.histogram;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
        histogram.sample_count += counts_[i].load(std::memory_order_relaxed);
        const bool has_bound = i < kBounds.size();
        histogram.bucket.push_back(
            {histogram.sample_count, has_bound ? kBounds[i] / 1e6 : std::numeric_limits<double>::infinity()});
    }
    histogram.sample_sum = static_cast<double>(nanoseconds_.load(std::memory_order_relaxed)) / 1e9;
    return {name_, help_, prometheus::MetricType::Histogram, {metric}};
}

} // namespace scanloom::metrics
