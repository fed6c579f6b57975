#include "lab/perturbed_source.hpp"

#include "tests/support/recorded_source.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace scanloom::lab {
namespace {

/// Returns the scans of a source with the given odometry and a perturbation. The stamps of the source are 0, 1, 2 ...
std::vector<Scan> scans_of(const std::vector<std::optional<Pose2>>& odometry, const Perturbation& perturbation) {
    std::vector<robot::Observation> observations(odometry.size());
    for (std::size_t i = 0; i < odometry.size(); ++i) {
        observations[i].scan.stamp = static_cast<double>(i);
        observations[i].scan.odometry = odometry[i];
    }
    robot::RecordedSource source(std::move(observations));
    PerturbedSource perturbed(source, perturbation);
    const auto count = perturbed.scan_count();
    std::vector<Scan> scans;
    for (auto next = perturbed.next(); next && *next; next = perturbed.next()) scans.push_back((*next)->scan);
    EXPECT_EQ(count, scans.size());
    return scans;
}

std::vector<double> stamps_of(const std::vector<Scan>& scans) {
    std::vector<double> stamps;
    for (const Scan& scan : scans) stamps.push_back(scan.stamp);
    return stamps;
}

const std::vector<std::optional<Pose2>> kCorner{Pose2{5, 5, 0}, Pose2{6, 5, 0.5}, Pose2{6, 5, 1.5}, Pose2{6, 6, 1.5}};

TEST(PerturbedSource, IsTheSourceByDefault) {
    const auto scans = scans_of(kCorner, {});
    ASSERT_EQ(scans.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(scans[i].odometry, kCorner[i]);
    EXPECT_FALSE(Perturbation{}.drops_scans());
}

TEST(PerturbedSource, ScalesEachMotionOfTheOdometry) {
    const std::vector<std::optional<Pose2>> straight{Pose2{5, 5, 0}, Pose2{6, 5, 0.1}, Pose2{6, 5, 0.3}};
    const auto scans = scans_of(straight, {.odometry_scale = 2.0});
    ASSERT_EQ(scans.size(), 3U);
    EXPECT_EQ(scans[0].odometry, (Pose2{5, 5, 0}));
    EXPECT_EQ(scans[1].odometry, (Pose2{7, 5, 0.2}));
    EXPECT_NEAR(scans[2].odometry->x, 7.0, 1e-12);
    EXPECT_NEAR(scans[2].odometry->y, 5.0, 1e-12);
    EXPECT_NEAR(scans[2].odometry->yaw, 0.6, 1e-12);
}

TEST(PerturbedSource, ScalesMotionsInTheRobotFrame) {
    const std::vector<std::optional<Pose2>> path{Pose2{0, 0, 0}, Pose2{0, 0, 1.0},
                                                 Pose2{std::cos(1.0), std::sin(1.0), 1.0}};
    const auto scans = scans_of(path, {.odometry_scale = 0.5});
    ASSERT_EQ(scans.size(), 3U);
    EXPECT_NEAR(scans[2].odometry->x, 0.5 * std::cos(0.5), 1e-12);
    EXPECT_NEAR(scans[2].odometry->y, 0.5 * std::sin(0.5), 1e-12);
}

TEST(PerturbedSource, ScansThatAreLeftOutMoveTheOdometryAsWell) {
    const auto all = scans_of(kCorner, {.odometry_scale = 1.5});
    const auto some = scans_of(kCorner, {.odometry_scale = 1.5, .skip = 1, .every = 2});
    ASSERT_EQ(some.size(), 2U);
    EXPECT_EQ(some[0].odometry, all[1].odometry);
    EXPECT_EQ(some[1].odometry, all[3].odometry);
}

TEST(PerturbedSource, LeavesOutScans) {
    const std::vector<std::optional<Pose2>> seven(7);
    EXPECT_EQ(stamps_of(scans_of(seven, {.skip = 5})), (std::vector<double>{5, 6}));
    EXPECT_EQ(stamps_of(scans_of(seven, {.every = 3})), (std::vector<double>{0, 3, 6}));
    EXPECT_EQ(stamps_of(scans_of(seven, {.skip = 1, .every = 3})), (std::vector<double>{1, 4}));
    EXPECT_TRUE(scans_of(seven, {.skip = 7}).empty());
    EXPECT_TRUE(scans_of(seven, {.skip = 100, .every = 2}).empty());
    EXPECT_TRUE((Perturbation{.every = 2}).drops_scans());
    EXPECT_TRUE((Perturbation{.skip = 1}).drops_scans());
}

TEST(PerturbedSource, ScansWithoutOdometryStayWithoutIt) {
    const auto scans = scans_of(std::vector<std::optional<Pose2>>(2), {.odometry_scale = 1.1});
    EXPECT_FALSE(scans[0].odometry || scans[1].odometry);
}

} // namespace
} // namespace scanloom::lab
