#include "server/landmarks/median.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace scanloom::landmarks {
namespace {

double median_of_copy(std::vector<double> values) { return median(values); }

TEST(Median, IsTheMiddleValue) {
    EXPECT_EQ(median_of_copy({3.0}), 3.0);
    EXPECT_EQ(median_of_copy({3.0, -1.0, 100.0}), 3.0);
    EXPECT_EQ(median_of_copy({5.0, 1.0, 5.0, 5.0, 2.0}), 5.0);
}

TEST(Median, OfAnEvenCountIsTheMeanOfTheMiddleTwo) {
    EXPECT_EQ(median_of_copy({1.0, 2.0}), 1.5);
    EXPECT_EQ(median_of_copy({9.0, 1.0, 4.0, -7.0}), 2.5);
    EXPECT_EQ(median_of_copy({4.0, 4.0, 1.0, 9.0}), 4.0);
}

} // namespace
} // namespace scanloom::landmarks
