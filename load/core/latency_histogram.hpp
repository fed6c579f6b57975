#pragma once

#include "load/core/micros.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace scanloom::load {

/// A histogram of durations with a resolution of three significant digits: below 2048 us each microsecond has its own
/// bucket, above that each doubling is divided into 1024 buckets. A percentile is therefore at most 0.1 % too large,
/// the memory is constant, and histograms of several threads can be added.
///
/// Units: microseconds, 0 to kMax; smaller values count as 0, larger ones as kMax.
/// Threads: one at a time.
/// Source: the layout of Gil Tene's HdrHistogram, http://hdrhistogram.org
class LatencyHistogram {
public:
    static constexpr Micros kMax = 3600 * kSecond; ///< an hour

    void record(Micros duration, std::uint64_t times = 1) noexcept;
    void add(const LatencyHistogram& other) noexcept;

    /// Returns what was recorded since `earlier`, a copy of this histogram from that time. Its max() is known to the
    /// bucket only.
    [[nodiscard]] LatencyHistogram since(const LatencyHistogram& earlier) const noexcept;

    [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
    [[nodiscard]] Micros max() const noexcept { return max_; } ///< exact; 0 if empty

    /// Returns the smallest duration that at least `percent` of all durations do not exceed, rounded up to the end of
    /// its bucket but never beyond max(); 0 if empty.
    /// Pre: 0 < percent <= 100.
    [[nodiscard]] Micros percentile(double percent) const noexcept;

private:
    static constexpr int kLinearBits = 11;                                    // 2048 buckets of one microsecond
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
