#include "load/core/latency_histogram.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

namespace scanloom::load {
namespace {

/// Computes the percentile by sorting: the smallest sample that at least `percent` of all samples do not exceed.
Micros sorted_percentile(std::vector<Micros> samples, double percent) {
    std::ranges::sort(samples);
    const auto rank = static_cast<std::size_t>(std::ceil(percent / 100.0 * static_cast<double>(samples.size())));
    return samples[std::max<std::size_t>(rank, 1) - 1];
}

std::vector<Micros> samples_over_all_scales(unsigned seed, std::size_t count) {
    std::mt19937_64 random(seed);
    std::vector<Micros> samples(count);
    for (auto& sample : samples) {
        sample = static_cast<Micros>(random() % static_cast<std::uint64_t>(LatencyHistogram::kMax)) >> random() % 32;
    }
    return samples;
}

std::unique_ptr<LatencyHistogram> histogram_of(const std::vector<Micros>& samples) {
    auto histogram = std::make_unique<LatencyHistogram>();
    for (const Micros sample : samples) histogram->record(sample);
    return histogram;
}

TEST(LatencyHistogram, PercentilesMatchSortedSamplesToThreeDigits) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
        const auto samples = samples_over_all_scales(seed, 10'000);
        const auto histogram = histogram_of(samples);
        for (const double percent : {0.001, 1.0, 25.0, 50.0, 90.0, 99.0, 99.9, 99.99, 100.0}) {
            const Micros exact = sorted_percentile(samples, percent);
            EXPECT_GE(histogram->percentile(percent), exact) << percent;
            EXPECT_LE(static_cast<double>(histogram->percentile(percent)), static_cast<double>(exact) * 1.001)
                << percent;
        }
        EXPECT_EQ(histogram->max(), *std::ranges::max_element(samples));
        EXPECT_EQ(histogram->count(), samples.size());
    }
}

TEST(LatencyHistogram, ResolutionIsOneMicrosecondBelowTwoMilliseconds) {
    auto histogram = std::make_unique<LatencyHistogram>();
    for (Micros sample = 1; sample <= 2000; ++sample) histogram->record(sample);
    for (int percent = 1; percent <= 100; ++percent) EXPECT_EQ(histogram->percentile(percent), 20 * percent);
}

TEST(LatencyHistogram, HandlesNoSampleOneSampleAndOutOfRangeSamples) {
    auto histogram = std::make_unique<LatencyHistogram>();
    EXPECT_EQ(histogram->percentile(99), 0);
    histogram->record(123'456);
    EXPECT_EQ(histogram->percentile(0.1), 123'456);
    EXPECT_EQ(histogram->percentile(100), 123'456);
    histogram->record(-5);
    EXPECT_EQ(histogram->percentile(50), 0);
    histogram->record(LatencyHistogram::kMax * 3);
    EXPECT_EQ(histogram->max(), LatencyHistogram::kMax);
    EXPECT_EQ(histogram->percentile(100), LatencyHistogram::kMax);
}

TEST(LatencyHistogram, HistogramsCanBeAddedAndSubtracted) {
    const auto first = samples_over_all_scales(6, 3000);
    const auto second = samples_over_all_scales(7, 2000);
    auto both = first;
    both.insert(both.end(), second.begin(), second.end());
    const auto whole = histogram_of(both);
    const auto earlier = histogram_of(first);

    auto sum = std::make_unique<LatencyHistogram>(*earlier);
    sum->add(*histogram_of(second));
    const auto later = std::make_unique<LatencyHistogram>(whole->since(*earlier));
    EXPECT_EQ(sum->count(), 5000U);
    EXPECT_EQ(sum->max(), whole->max());
    EXPECT_EQ(later->count(), 2000U);
    for (const double percent : {1.0, 50.0, 99.0, 100.0}) {
        EXPECT_EQ(sum->percentile(percent), whole->percentile(percent));
        EXPECT_GE(later->percentile(percent), sorted_percentile(second, percent));
        EXPECT_LE(static_cast<double>(later->percentile(percent)),
                  static_cast<double>(sorted_percentile(second, percent)) * 1.001);
    }
}

} // namespace
} // namespace scanloom::load
