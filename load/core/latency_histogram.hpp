#pragma once

#include "load/core/micros.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace scanloom::load {

/// How often which duration occurred, in buckets that are as fine as three significant digits wherever one looks:
/// below 2048 us each microsecond has one, and from there on each doubling is divided into 1024. So a percentile is
/// never more than 0.1 % too large, the memory is fixed, and histograms of several threads add up.
///
/// Units   microseconds, 0 to kMax; what is less counts as 0, what is more as kMax.
/// Thread  one at a time.
/// Source  the layout of Gil Tene's HdrHistogram, http://hdrhistogram.org
class LatencyHistogram {
public:
    static constexpr Micros kMax = 3600 * kSecond; ///< an hour

    void record(Micros duration, std::uint64_t times = 1) noexcept;
    void add(const LatencyHistogram& other) noexcept;

    /// What was recorded since `earlier`, a copy of this made then. Of its largest the bucket is known.
    [[nodiscard]] LatencyHistogram since(const LatencyHistogram& earlier) const noexcept;

    [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
    [[nodiscard]] Micros max() const noexcept { return max_; } ///< exact; 0 of none

    /// The least duration that at least `percent` of all do not exceed, rounded up to the end of its bucket, but never
    /// beyond max(); 0 of none.
    /// Pre  0 < percent <= 100
    [[nodiscard]] Micros percentile(double percent) const noexcept;

private:
    static constexpr int kLinearBits = 11;                                    // 2048 buckets of a microsecond
    static constexpr std::size_t kHalf = std::size_t{1} << (kLinearBits - 1); // buckets of each further doubling
    static constexpr int kDoublings = 21;                                     // 2048 us << 21 exceeds an hour
    static constexpr std::size_t kBuckets = 2 * kHalf + kDoublings * kHalf;

    [[nodiscard]] static std::size_t bucket_of(Micros duration) noexcept;
    [[nodiscard]] static Micros end_of(std::size_t bucket) noexcept;

    std::array<std::uint64_t, kBuckets> counts_{};
    std::uint64_t count_ = 0;
    Micros max_ = 0;
};

} // namespace scanloom::load
