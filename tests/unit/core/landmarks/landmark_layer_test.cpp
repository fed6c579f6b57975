#include "core/landmarks/landmark_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

namespace scanloom::landmarks {
namespace {

using testing::DoubleNear;
using testing::SizeIs;

constexpr std::size_t kBeams = 360;

const Sensor kPillarLaser{.id = 1,
                          .kind = SensorKind::kLaser,
                          .name = "laser",
                          .angles = UniformAngles{0.0, 2 * std::numbers::pi / kBeams, kBeams},
                          .aperture = 0.02,
                          .range_min = 0.05,
                          .range_max = 12.0};

/// Round pillars in empty space.
const std::vector<Point2> kPillars = {{3.0, 1.0}, {1.0, -3.0}, {-2.5, -1.5}, {-1.0, 3.2}};
constexpr double kRadius = 0.25;

RangeMm range_to_pillars(const Point2& from, double direction) {
    double nearest = INFINITY;
    const Point2 along{std::cos(direction), std::sin(direction)};
    for (const auto& pillar : kPillars) {
        const double ahead = dot(pillar - from, along);
        const double aside = std::abs(along.x * (pillar - from).y - along.y * (pillar - from).x);
        if (ahead > 0 && aside < kRadius) {
            nearest = std::min(nearest, ahead - std::sqrt(kRadius * kRadius - aside * aside));
        }
    }
    return to_range_mm(nearest);
}

class LandmarkLayerTest : public testing::Test {
protected:
    Scan scan(const Pose2& pose) {
        Scan scan{.seq = revision_, .stamp = 0.1 * static_cast<double>(revision_), .sensor = 1, .pose = pose};
        for (std::size_t beam = 0; beam < kBeams; ++beam) {
            scan.ranges.push_back(range_to_pillars({pose.x, pose.y}, pose.yaw + beam_angle(kPillarLaser.angles, beam)));
        }
        return scan;
    }

    void see(LandmarkLayer& layer, RobotIndex robot, const Pose2& pose) {
        ++revision_;
        const auto ended = cutters_[robot].add(scan(pose), kPillarLaser, revision_);
        if (ended) layer.add({robot, *ended, revision_});
    }

    std::array<CaptureCutter, 5> cutters_;
    Revision revision_ = 0;
};

TEST_F(LandmarkLayerTest, ObjectObservedFromSeveralPlacesIsOneLandmark) {
    LandmarkLayer layer;
    for (const auto& place : {Pose2{}, Pose2{0.3, 0.6, 1.0}, Pose2{-0.4, 0.2, -2.0}}) {
        for (std::uint32_t n = 0; n < kCaptureScansMax; ++n) see(layer, 0, place);
    }
    const auto state = layer.snapshot();
    EXPECT_EQ(state.captures, 3U);
    ASSERT_EQ(state.landmarks.size(), kPillars.size());
    for (std::size_t id = 0; id < state.landmarks.size(); ++id) {
        const auto& found = state.landmarks[id];
        EXPECT_EQ(found.seen, 3U);
        const auto nearest = std::ranges::min(
            kPillars, {}, [&](const Point2& pillar) { return norm(pillar - found.landmark.position); });
        EXPECT_LT(norm(nearest - found.landmark.position), kRadius + 0.01);
    }
    EXPECT_EQ(state.sums.persistence_pairs, 2U);
    EXPECT_THAT(state.sums.persistence, DoubleNear(2.0, 1e-12));
    EXPECT_EQ(state.sums.landmarks, 12U);
}

/// Clients request landmarks newer than an entry, so a landmark must not be older than the entry that ended its
/// capture.
TEST_F(LandmarkLayerTest, LandmarkHasTheRevisionThatEndedItsCapture) {
    LandmarkLayer layer;
    see(layer, 0, {});
    see(layer, 0, {});
    see(layer, 0, {0.1, 0.0, 0.0});
    const auto state = layer.snapshot();
    ASSERT_EQ(state.landmarks.size(), kPillars.size());
    EXPECT_EQ(state.landmarks[0].first, 3U);
    EXPECT_EQ(state.landmarks[0].last, 3U);
}

TEST_F(LandmarkLayerTest, PairsCapturesOfTheSameRobotOnly) {
    LandmarkLayer layer;
    see(layer, 4, {});
    see(layer, 2, {});
    see(layer, 4, {1.0, 0.0, 0.0}); // ends the robot's first capture
    see(layer, 2, {1.0, 0.0, 0.0});
    EXPECT_EQ(layer.snapshot().captures, 2U);
    EXPECT_EQ(layer.snapshot().sums.persistence_pairs, 0U);
    see(layer, 4, {0.0, 0.0, 0.0});
    EXPECT_EQ(layer.snapshot().captures, 3U);
    EXPECT_EQ(layer.snapshot().sums.persistence_pairs, 1U);
}

TEST_F(LandmarkLayerTest, CapturesWithoutReadingsHaveNoLandmarks) {
    LandmarkLayer layer;
    for (int n = 0; n < 20; ++n) see(layer, 0, {1000.0 + n, 0.0, 0.0});
    EXPECT_EQ(layer.snapshot().captures, 19U);
    EXPECT_EQ(layer.snapshot().landmarks.size(), 0U);
    EXPECT_EQ(layer.snapshot().sums.persistence_pairs, 0U) << "captures without landmarks are not counted as pairs";
}

} // namespace
} // namespace scanloom::landmarks
