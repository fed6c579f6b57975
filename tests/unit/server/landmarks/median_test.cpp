#include "server/landmarks/median.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace scanloom::landmarks {
namespace {

double median_of(std::vector<double> values) { return median(values); }

TEST(Median, IsTheMiddleValue) {
    EXPECT_EQ(median_of({3.0}), 3.0);
    EXPECT_EQ(median_of({3.0, -1.0, 100.0}), 3.0);
    EXPECT_EQ(median_of({5.0, 1.0, 5.0, 5.0, 2.0}), 5.0);
}

TEST(Median, OfAnEvenCountIsTheMeanOfTheMiddleTwo) {
    EXPECT_EQ(median_of({1.0, 2.0}), 1.5);
    EXPECT_EQ(median_of({9.0, 1.0, 4.0, -7.0}), 2.5);
    EXPECT_EQ(median_of({4.0, 4.0, 1.0, 9.0}), 4.0);
}

} // namespace
} // namespace scanloom::landmarks
