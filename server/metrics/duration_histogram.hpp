#pragma once

#include <prometheus/metric_family.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>

namespace scanloom::metrics {

/// Counts durations in a Prometheus histogram in seconds, with buckets from 0.5 ms to 10 s.
/// Cost: observe() does a search among 14 bounds and two atomic additions; no lock.
/// Threads: any thread.
class DurationHistogram {
public:
    /// @param name  of the metric; ends in _seconds
    DurationHistogram(std::string name, std::string help) : name_(std::move(name)), help_(std::move(help)) {}

    /// Records `times` observations, each with the duration `took`.
    void observe(std::chrono::nanoseconds took, std::uint64_t times = 1) noexcept;

    /// Returns the current values. The counts are consistent with one another; the sum may lack observations that are
    /// being recorded.
    [[nodiscard]] prometheus::MetricFamily family() const;

private:
    /// Inclusive upper bounds, in microseconds. A cached tile takes a fraction of a millisecond, a whole map seconds.
    static constexpr std::array<std::uint32_t, 14> kBounds = {500,       1'000,     2'500,     5'000,     10'000,
                                                              25'000,    50'000,    100'000,   250'000,   500'000,
                                                              1'000'000, 2'500'000, 5'000'000, 10'000'000};

    std::string name_;
    std::string help_;
    std::array<std::atomic<std::uint64_t>, kBounds.size() + 1> counts_{}; // by bucket; the last has no upper bound
    std::atomic<std::uint64_t> nanoseconds_ = 0;                          // overflows after 584 years
};

} // namespace scanloom::metrics
