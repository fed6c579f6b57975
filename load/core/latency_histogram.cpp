#include "load/core/latency_histogram.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

namespace scanloom::load {

std::size_t LatencyHistogram::bucket_of(Micros duration) noexcept {
    const auto value = static_cast<std::uint64_t>(duration);
    const int doublings = std::max(0, static_cast<int>(std::bit_width(value)) - kLinearBits); // above the linear part
    return static_cast<std::size_t>(doublings) * kHalf + static_cast<std::size_t>(value >> doublings);
}

/// Returns the longest duration of a bucket.
Micros LatencyHistogram::end_of(std::size_t bucket) noexcept {
    if (bucket < 2 * kHalf) return static_cast<Micros>(bucket);
    const std::size_t doublings = bucket / kHalf - 1;
    const std::size_t step = bucket % kHalf + kHalf;
    return static_cast<Micros>(((step + 1) << doublings) - 1);
}

void LatencyHistogram::record(Micros duration, std::uint64_t times) noexcept {
    if (times == 0) return;
    duration = std::clamp<Micros>(duration, 0, kMax);
    counts_[bucket_of(duration)] += times;
    count_ += times;
    max_ = std::max(max_, duration);
}

void LatencyHistogram::add(const LatencyHistogram& other) noexcept {
    for (std::size_t i = 0; i < kBuckets; ++i) counts_[i] += other.counts_[i];
    count_ += other.count_;
    max_ = std::max(max_, other.max_);
}

LatencyHistogram LatencyHistogram::since(const LatencyHistogram& earlier) const noexcept {
    LatencyHistogram recent;
    std::size_t last = 0;
    for (std::size_t i = 0; i < kBuckets; ++i) {
        recent.counts_[i] = counts_[i] - earlier.counts_[i];
        if (recent.counts_[i] > 0) last = i;
    }
    recent.count_ = count_ - earlier.count_;
    recent.max_ = std::min(max_, end_of(last));
    return recent;
}

Micros LatencyHistogram::percentile(double percent) const noexcept {
    assert(percent > 0.0 && percent <= 100.0);
    const auto wanted = static_cast<std::uint64_t>(std::ceil(percent / 100.0 * static_cast<double>(count_)));
    std::uint64_t seen = 0;
    for (std::size_t i = 0; i < kBuckets && count_ > 0; ++i) {
        seen += counts_[i];
        if (seen >= std::max<std::uint64_t>(wanted, 1)) return std::min(end_of(i), max_);
    }
    return max_;
}

} // namespace scanloom::load
