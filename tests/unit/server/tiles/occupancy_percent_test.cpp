#include "server/tiles/occupancy_percent.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace scanloom::tiles {
namespace {

TEST(OccupancyPercent, IsTheRoundedProbabilityOfEveryFixedPointValue) {
    for (int fixed = -32767; fixed <= 32767; ++fixed) {
        const double probability = 1.0 - 1.0 / (1.0 + std::exp(fixed / 2048.0));
        const int percent = percent_table()[static_cast<std::uint16_t>(fixed)];
        ASSERT_NEAR(percent, 100.0 * probability, 0.5 + 1e-9) << fixed;
    }
    EXPECT_EQ(percent_table()[static_cast<std::uint16_t>(mapping::kUnknownLogOdds)], kUnknownPercent);
    EXPECT_EQ(percent_table()[0], 50);
}

TEST(OccupancyPercent, SalienceRanksFirstTheFurthestAboveHalfThenTheLowest) {
    int before = kUnknownSalience;
    const auto expect_next = [&](int percent) {
        const auto salience = salience_of(static_cast<Percent>(percent));
        EXPECT_EQ(salience, before + 1) << percent;
        EXPECT_EQ(percent_of_salience(salience), percent);
        before = salience;
    };
    for (int percent = 50; percent >= 0; --percent) expect_next(percent);
    for (int percent = 51; percent <= 100; ++percent) expect_next(percent);
    EXPECT_EQ(salience_of(kUnknownPercent), kUnknownSalience);
    EXPECT_EQ(percent_of_salience(kUnknownSalience), kUnknownPercent);
}

TEST(OccupancyPercent, GreysTellEveryPercentageApartAndNoneFromUnknown) {
    std::set<int> greys{grey_of(kUnknownPercent)};
    for (int percent = 0; percent <= 100; ++percent) {
        const int grey = grey_of(static_cast<Percent>(percent));
        EXPECT_NEAR(grey, 255.0 * (1.0 - percent / 100.0), 0.5 + 1e-9);
        greys.insert(grey);
    }
    EXPECT_EQ(greys.size(), 102U);
    EXPECT_EQ(grey_of(0), 255);
    EXPECT_EQ(grey_of(100), 0);
    EXPECT_EQ(grey_of(kUnknownPercent), 128);
}

} // namespace
} // namespace scanloom::tiles
