#include "sim/noise.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace scanloom::sim {
namespace {

TEST(Random, UniformValuesAreEqualOnEveryMachine) {
    // The C++ standard specifies the 10,000th value of this engine for its default seed.
    Random random(5489);
    for (int i = 0; i < 9999; ++i) static_cast<void>(random.uniform(0.0, 1.0));
    EXPECT_EQ(random.uniform(0.0, 1.0), static_cast<double>(9981545732273789042ULL >> 11) * 0x1p-53);
}

TEST(Random, GaussianValuesHaveMeanAndDeviation) {
    Random random(5);
    double sum = 0.0;
    double squares = 0.0;
    constexpr int kCount = 100'000;
    for (int i = 0; i < kCount; ++i) {
        const double value = random.gaussian(0.5);
        sum += value;
        squares += value * value;
    }
    EXPECT_NEAR(sum / kCount, 0.0, 0.01);
    EXPECT_NEAR(std::sqrt(squares / kCount), 0.5, 0.01);
}

TEST(Random, IndicesCoverTheirRange) {
    Random random(6);
    int counts[3] = {};
    for (int i = 0; i < 3000; ++i) ++counts[random.index(3)];
    for (const int count : counts) EXPECT_GT(count, 900);
}

} // namespace
} // namespace scanloom::sim
