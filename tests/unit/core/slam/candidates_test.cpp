#include "core/scan_matching/agreement.hpp"
#include "core/scan_matching/line_matching.hpp"
#include "core/slam/candidates.hpp"
#include "tests/support/uniform.hpp"
#include "tests/unit/core/slam/other_buildings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <random>
#include <vector>

namespace scanloom::slam {
namespace {

using scan_matching::SurfacePoint;
using scan_matching::transform_of;
using testing_support::Building;
using testing_support::uniform;

ScanPoints seen(const Building& building, const Pose2& pose, std::mt19937& random) {
    return scan_matching::points_of(building.scan(Building::laser(), pose, 0.01, random), Building::laser());
}

/// Returns the map of what a robot saw at some poses.
KeyframeMap map_of(const Building& building, const std::vector<Pose2>& poses, std::mt19937& random) {
    KeyframeViews views;
    for (const Pose2& pose : poses) {
        views.add({.scan = std::make_shared<const ScanPoints>(seen(building, pose, random))}, transform_of(pose));
    }
    return KeyframeMap(std::move(views));
}

bool are_close(const Transform2& a, const Transform2& b, double distance, double turn) {
    const Transform2 off = inverse(a) * b;
    return distance_of(off) < distance && std::fabs(yaw_of(off)) < turn;
}

bool have_match_at(const std::vector<Candidate>& candidates, const Transform2& pose) {
    return std::ranges::any_of(candidates, [&](const Candidate& candidate) {
        return candidate.scan.is_matched && are_close(candidate.scan.T_keyframe_robot, pose, 0.05, 0.03);
    });
}

/// A room with a box at a random place, the map of three views, and a scan.
struct RandomRoom {
    explicit RandomRoom(std::mt19937& random) {
        Building room;
        room.add_box(-uniform(random, 2.0, 4.0), -3.0, 5.0, uniform(random, 2.0, 4.0));
        const double x = uniform(random, 1.5, 3.5);
        room.add_box(x, 0.5, x + 0.6, uniform(random, 1.0, 1.6));
        const auto place = [&] {
            return Pose2{uniform(random, -1.0, 0.5), uniform(random, -1.0, 0.3), uniform(random, -0.6, 0.6)};
        };
        map = map_of(room, {place(), place(), place()}, random);
        const Pose2 pose = place();
        scan = seen(room, pose, random);
        truth = transform_of(pose);
    }

    /// Returns the pose of the best agreement of those in a grid around the truth, refined.
    Transform2 best_pose() {
        ScanPoints some;
        for (std::size_t n = 0; n < scan.points.size(); n += 7) some.points.push_back(scan.points[n]);
        Transform2 best;
        double most = -HUGE_VAL;
        for (double x = -0.6; x <= 0.6; x += 0.1) {
            for (double y = -0.6; y <= 0.6; y += 0.1) {
                for (double yaw = -0.6; yaw <= 0.6; yaw += 0.06) {
                    const Transform2 pose = truth * transform_of({x, y, yaw});
                    const double score = agreement_of(some, map.points(), map.space(), pose).score;
                    if (score <= most) continue;
                    most = score;
                    best = pose;
                }
            }
        }
        return match_to_lines(scan.points, map.points(), best, {best, 1.0, 1.0}, {}).T_map_robot;
    }

    KeyframeMap map;
    ScanPoints scan;
    Transform2 truth;
};

/// Some rooms are too much like themselves at another pose; then no candidate may be the best one.
TEST(Candidates, ContainTheBestPoseOfAnExhaustiveSearch) {
    std::mt19937 random(1);
    constexpr int kRounds = 60;
    int found_with_odometry = 0;
    int found_without = 0;
    for (int round = 0; round < kRounds; ++round) {
        RandomRoom room(random);
        const Transform2 best = room.best_pose();
        for (const bool has_odometry : {true, false}) {
            const auto wrong = [&] { // wheels slip, and the robot is pushed
                return room.truth * transform_of({uniform(random, -0.3, 0.3), uniform(random, -0.1, 0.1),
                                                  uniform(random, -0.8, 0.8)});
            };
            Prediction prediction{.velocity = wrong()};
            if (has_odometry) prediction.odometry = wrong();
            const auto candidates = candidates_of(room.scan, room.map, prediction, Care::kValued);
            (has_odometry ? found_with_odometry : found_without) += have_match_at(candidates, best) ? 1 : 0;
            for (const Candidate& a : candidates) {
                for (const Candidate& b : candidates) {
                    if (&a == &b || !a.scan.is_matched || !b.scan.is_matched) continue;
                    ASSERT_FALSE(are_close(a.scan.T_keyframe_robot, b.scan.T_keyframe_robot, 0.04, 0.02))
                        << "the same twice";
                }
            }
        }
    }
    EXPECT_GE(found_with_odometry, kRounds * 9 / 10);
    EXPECT_GE(found_without, kRounds * 9 / 10);
}

TEST(Candidates, AreOneWhereNothingIsDoubtful) {
    std::mt19937 random(2);
    for (int round = 0; round < 10; ++round) {
        RandomRoom room(random);
        const Transform2 almost = room.truth * transform_of({0.03, -0.02, 0.02});
        const Prediction prediction{.velocity = room.truth, .odometry = almost};
        const auto plain = candidates_of(room.scan, room.map, prediction, Care::kOneIfPlain);
        ASSERT_EQ(plain.size(), 1U);
        EXPECT_TRUE(have_match_at(plain, room.truth));
        EXPECT_EQ(plain[0].value, 0.0);
        EXPECT_GT(plain[0].scan.position_sigma, 0.0);
        const auto valued = candidates_of(room.scan, room.map, prediction, Care::kValued);
        ASSERT_EQ(valued.size(), 1U);
        EXPECT_GT(valued[0].value, 0.7) << "to be compared with those of other predictions";
    }
}

/// In a straight corridor, the scan does not show how far the robot moved.
TEST(Candidates, AreWhereOdometryAndVelocityDisagree) {
    std::mt19937 random(3);
    Building corridor;
    corridor.walls = {{{-60.0, -1.0}, {60.0, -1.0}}, {{-60.0, 1.0}, {60.0, 1.0}}};
    std::vector<Pose2> poses; // many, so that the map has no gaps
    for (double x = -6.0; x < 6.0; x += 0.23) poses.push_back({x, 0.0, 0.0});
    KeyframeMap map = map_of(corridor, poses, random);
    const ScanPoints scan = seen(corridor, {0.1, 0.0, 0.0}, random);
    const auto candidates_for = [&](double odometry, double velocity) {
        return candidates_of(scan, map, {.velocity = {velocity, 0.0, {}}, .odometry = Transform2{odometry, 0.0, {}}},
                             Care::kValued);
    };
    const auto doubtful = candidates_for(0.4, 0.1);
    EXPECT_TRUE(have_match_at(doubtful, {0.4, 0.0, {}}));
    EXPECT_TRUE(have_match_at(doubtful, {0.1, 0.0, {}}));
    const auto& best = *std::ranges::max_element(doubtful, {}, &Candidate::value);
    EXPECT_NEAR(best.scan.T_keyframe_robot.x, 0.4, 0.05) << "odometry is wrong less often than velocity";
    EXPECT_EQ(candidates_for(0.15, 0.1).size(), 1U);
}

TEST(Candidates, EndWithThePredictionWhereNothingFits) {
    std::mt19937 random(4);
    RandomRoom room(random);
    ScanPoints people = room.scan; // all around
    for (SurfacePoint& point : people.points) {
        const float distance = std::sqrt(point.x * point.x + point.y * point.y);
        point = {.x = 0.5F * point.x / distance, .y = 0.5F * point.y / distance};
    }
    for (const bool has_odometry : {true, false}) {
        Prediction prediction{.velocity = room.truth};
        if (has_odometry) prediction.odometry = room.truth;
        for (const ScanPoints& scan : {people, ScanPoints()}) {
            const auto candidates = candidates_of(scan, room.map, prediction, Care::kOneIfPlain);
            EXPECT_FALSE(candidates.back().scan.is_matched);
            EXPECT_EQ(candidates.back().scan.inlier_ratio, 0.0);
            EXPECT_TRUE(are_close(candidates.back().scan.T_keyframe_robot, room.truth, 1e-9, 1e-9));
            EXPECT_GT(candidates.back().value, 0.0) << "better than a pose that contradicts the map";
            EXPECT_EQ(std::ranges::max_element(candidates, {}, &Candidate::value), candidates.end() - 1);
            EXPECT_TRUE(std::ranges::none_of(candidates, [](const auto& each) { return each.scan.is_matched; }));
        }
    }
}

/// A robot that was bumped or tilted did not move, even if what it sees then fits better at another place.
TEST(Candidates, AreFarFromThePredictionsOnlyIfAlmostAllPointsFit) {
    std::mt19937 random(5);
    const Building hall = other_building();
    const Pose2 start{1.5, 1.5, 0.6};
    KeyframeMap map = map_of(hall, {start, {2.0, 2.0, 0.4}}, random);
    const Pose2 moved = compose(start, {0.45, 0.0, 0.0});
    const ScanPoints scan = seen(hall, moved, random);
    ScanPoints tilted = scan;
    for (std::size_t n = 0; n < tilted.points.size(); n += 4) {
        tilted.points[n].x *= 0.5F;
        tilted.points[n].y *= 0.5F;
    }
    const auto is_far_away = [&](const ScanPoints& points, const Prediction& prediction) {
        return have_match_at(candidates_of(points, map, prediction, Care::kValued), transform_of(moved));
    };
    Prediction prediction{.last = transform_of(start), .odometry = Transform2()};
    EXPECT_TRUE(is_far_away(scan, prediction));
    EXPECT_FALSE(is_far_away(tilted, prediction));
    prediction.odometry.reset();
    EXPECT_TRUE(is_far_away(scan, prediction));
    EXPECT_FALSE(is_far_away(tilted, prediction));
}

} // namespace
} // namespace scanloom::slam
