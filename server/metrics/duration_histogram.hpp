#pragma once

#include <prometheus/metric_family.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>

namespace scanloom::metrics {

/// How long something took, each time: a Prometheus histogram in seconds, with buckets from 0.5 ms to 10 s.
/// Cost    observe(): a search among 14 bounds and two atomic additions; no lock.
/// Thread  any.
class DurationHistogram {
public:
    /// `name` ends in _seconds.
    DurationHistogram(std::string name, std::string help) : name_(std::move(name)), help_(std::move(help)) {}

    /// `times` things took so long each.
    void observe(std::chrono::nanoseconds took, std::uint64_t times = 1) noexcept;

    /// As of now. The counts agree with one another; the sum may lack what is being observed.
    [[nodiscard]] prometheus::MetricFamily family() const;

private:
    /// Inclusive, in microseconds. A cached tile takes a fraction of a millisecond, a whole map seconds.
    static constexpr std::array<std::uint32_t, 14> kBounds = {500,       1'000,     2'500,     5'000,     10'000,
                                                              25'000,    50'000,    100'000,   250'000,   500'000,
                                                              1'000'000, 2'500'000, 5'000'000, 10'000'000};

    std::string name_;
    std::string help_;
    std::array<std::atomic<std::uint64_t>, kBounds.size() + 1> counts_{}; // by bucket; the last has no bound
    std::atomic<std::uint64_t> nanoseconds_ = 0;                          // 584 years of them
};

} // namespace scanloom::metrics
