#include "core/slam/tracker.hpp"
#include "tests/unit/core/slam/drive.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <random>
#include <vector>

namespace scanloom::slam {
namespace {

using scan_matching::transform_of;
using testing_support::Building;

constexpr double kStep = 0.06; // metres between scans

bool never(const TrackedScan& /*scan*/) { return false; }

/// A robot in a straight corridor, where a laser that sees 4 m does not show how far the robot moves. At one scan its
/// wheels slip: the odometry counts 0.3 m too much. A cupboard at 6 m is in the map, which was made before.
class TrackerInACorridor : public testing::Test {
protected:
    TrackerInACorridor() {
        corridor_.walls = {{{-60.0, -1.0}, {60.0, -1.0}}, {{-60.0, 1.0}, {60.0, 1.0}}};
        corridor_.add_box(6.0, -1.0, 6.4, 0.3);
        laser_.range_max = 4.0;
    }

    /// Begins at a place of the corridor.
    void begin(double at) {
        at_ = at;
        KeyframeViews views;
        for (double x = -2.0; x < 8.0; x += 0.8) {
            views.add({.scan = std::make_shared<const ScanPoints>(scan_at(x))}, {x, 0.0, {}});
        }
        tracker_.begin(KeyframeMap(std::move(views)), {at, 0.0, {}});
    }

    [[nodiscard]] ScanPoints scan_at(double x) {
        return scan_matching::points_of(corridor_.scan(laser_, {x, 0.0, 0.0}, 0.01, random_), laser_);
    }

    /// Moves by a step, and adds a scan. @param counted  metres by the odometry
    template <class IsDue>
    std::vector<TrackedScan> move(double counted, IsDue is_due) {
        at_ += kStep;
        truth_.push_back(at_);
        const auto decided = tracker_.add(scan_at(at_), Transform2{counted, 0.0, {}}, is_due);
        decided_.insert(decided_.end(), decided.begin(), decided.end());
        EXPECT_EQ(decided_.size() + tracker_.open_count(), truth_.size()) << "each scan is decided once";
        return decided;
    }

    [[nodiscard]] double error_of(std::size_t scan) const {
        return distance_of(inverse(decided_[scan].T_keyframe_robot) * Transform2{truth_[scan], 0.0, {}});
    }

    Building corridor_;
    Sensor laser_ = Building::laser();
    std::mt19937 random_{1};
    Tracker tracker_;
    double at_ = 0.0;
    std::vector<double> truth_; // x of the scans
    std::vector<TrackedScan> decided_;
};

TEST_F(TrackerInACorridor, FollowsHypothesesUntilTheSightDecides) {
    begin(1.6);
    for (int n = 0; n < 5; ++n) EXPECT_EQ(move(kStep, never).size(), 1U) << "nothing is doubtful";
    ASSERT_TRUE(move(kStep + 0.3, never).empty());
    EXPECT_NEAR(tracker_.newest().T_keyframe_robot.x, at_ + 0.3, 0.05) << "at first the odometry counts";
    while (tracker_.open_count() > 0) static_cast<void>(move(kStep, never));
    EXPECT_LT(decided_.size(), 5 + Tracker::kOpenMax);
    for (std::size_t n = 0; n < decided_.size(); ++n)
        EXPECT_LT(error_of(n), 0.05) << n << ", also those that were open";
}

TEST_F(TrackerInACorridor, DecidesAfterTwelveScansIfTheSightDoesNot) {
    begin(-2.0);
    for (int n = 0; n < 5; ++n) EXPECT_EQ(move(kStep, never).size(), 1U);
    ASSERT_TRUE(move(kStep + 0.3, never).empty());
    for (std::size_t n = 2; n < Tracker::kOpenMax; ++n) EXPECT_TRUE(move(kStep, never).empty()) << n;
    EXPECT_EQ(move(kStep, never).size(), Tracker::kOpenMax);
    EXPECT_EQ(tracker_.open_count(), 0U);
    EXPECT_NEAR(decided_.back().T_keyframe_robot.x, at_ + 0.3, 0.05) << "for the best one, that of the odometry";
    EXPECT_EQ(move(kStep, never).size(), 1U) << "the others are forgotten";
}

TEST_F(TrackerInACorridor, DecidesWhenAKeyframeIsDue) {
    begin(-2.0);
    const auto is_due = [](const TrackedScan& scan) { return scan.T_keyframe_robot.x > -1.4; };
    for (int n = 0; n < 3; ++n) EXPECT_EQ(move(kStep, is_due).size(), 1U);
    EXPECT_TRUE(move(kStep + 0.3, is_due).empty()) << "at -1.46";
    EXPECT_EQ(move(kStep + 0.03, is_due).size(), 2U) << "at -1.37";
}

TEST_F(TrackerInACorridor, DecidesWhenAsked) {
    begin(-2.0);
    EXPECT_TRUE(tracker_.decide().empty());
    static_cast<void>(move(kStep + 0.3, never));
    ASSERT_EQ(tracker_.open_count(), 1U);
    EXPECT_EQ(tracker_.decide().size(), 1U);
    EXPECT_EQ(tracker_.open_count(), 0U);
}

/// Without odometry, it may have stopped: each scan that shows nothing halves the velocity.
TEST_F(TrackerInACorridor, GoesOnSlowerWhileScansShowNothing) {
    for (const bool has_odometry : {true, false}) {
        begin(4.0);
        const auto motion = has_odometry ? std::optional(Transform2{kStep, 0.0, {}}) : std::nullopt;
        for (int n = 0; n < 10; ++n) {
            at_ += kStep;
            static_cast<void>(tracker_.add(scan_at(at_), motion, never));
        }
        EXPECT_NEAR(tracker_.velocity().x, kStep, 0.02);
        EXPECT_EQ(tracker_.unmatched(), 0U);
        double expected = at_;
        double velocity = tracker_.velocity().x;
        for (std::size_t n = 1; n <= 4; ++n) {
            expected += has_odometry ? kStep : velocity;
            velocity *= 0.5;
            const auto decided = tracker_.add({}, motion, [](const TrackedScan&) { return true; });
            const TrackedScan& newest = decided.empty() ? tracker_.newest() : decided.back();
            EXPECT_FALSE(newest.is_matched);
            EXPECT_NEAR(newest.T_keyframe_robot.x, expected, 0.03) << n;
            EXPECT_EQ(tracker_.unmatched(), n);
        }
        static_cast<void>(tracker_.decide());
        static_cast<void>(tracker_.add(scan_at(expected), motion, never));
        EXPECT_EQ(tracker_.unmatched(), 0U);
        static_cast<void>(tracker_.decide());
    }
}

} // namespace
} // namespace scanloom::slam
