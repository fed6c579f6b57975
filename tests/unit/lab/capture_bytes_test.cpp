#include "lab/recording.hpp"

#include <gtest/gtest.h>

namespace scanloom::lab {
namespace {

Scan scan_of(std::size_t beams) {
    Scan scan;
    scan.seq = 1;
    scan.ranges.assign(beams, 1234);
    return scan;
}

TEST(CaptureBytes, RobotBytesAreOneFramePerScan) {
    const std::vector<Scan> scans{scan_of(360), scan_of(260)};
    const auto long_one = robot_bytes(std::span(scans).first(1));
    const auto short_one = robot_bytes(std::span(scans).last(1));
    EXPECT_EQ(long_one - short_one, 100U * 4U) << "four bytes per reading";
    EXPECT_EQ(robot_bytes(scans), long_one + short_one);
    EXPECT_GT(short_one, 260U * 4U);
    EXPECT_LT(short_one, 260U * 4U + 100U);
    EXPECT_EQ(robot_bytes({}), 0U);
}

TEST(CaptureBytes, ServerBytesFollowFromPointsDistinctPointsAndCells) {
    EXPECT_EQ(clustering_bytes({}, 0.1), 0U);
    const std::vector<Point2> one{{0.0, 0.0}};
    EXPECT_EQ(clustering_bytes(one, 0.1), 24U + 52U + 56U);
    const std::vector<Point2> three{{0.0, 0.0}, {5.0, 5.0}, {0.0, 0.0}};
    EXPECT_EQ(clustering_bytes(three, 0.1), 3U * 24U + 2U * 52U + 2U * 56U);
    EXPECT_EQ(clustering_bytes(three, 100.0), 3U * 24U + 2U * 52U + 56U) << "all points are in one cell";
}

} // namespace
} // namespace scanloom::lab
