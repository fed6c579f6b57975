#include "core/landmarks/alignment_evidence.hpp"
#include "core/landmarks/alignment_hypotheses.hpp"
#include "core/landmarks/refinement.hpp"
#include "tests/support/angles.hpp"
#include "tests/unit/core/landmarks/pose_errors.hpp"
#include "tests/unit/core/landmarks/random_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

// Parts of an alignment: surface elements, hypotheses, refinement, evidence.

namespace scanloom::landmarks {
namespace {

using namespace testing_support;

/// Returns noisy points on the border of a room around the origin that has no rotational symmetry.
std::vector<Point2> odd_room(std::mt19937& random) {
    const std::vector<Point2> corners = {{-3.0, -2.0}, {3.0, -2.0}, {3.0, 1.0}, {1.0, 1.0}, {1.0, 3.0}, {-3.0, 3.0}};
    std::vector<Point2> points;
    for (std::size_t side = 0; side < corners.size(); ++side) {
        const Point2& a = corners[side];
        const Point2& b = corners[(side + 1) % corners.size()];
        for (int n = 0; n < 600; ++n) {
            const Point2 noise{uniform(random, -0.02, 0.02), uniform(random, -0.02, 0.02)};
            points.push_back(a + (b - a) * uniform(random, 0.0, 1.0) + noise);
        }
    }
    return points;
}

std::vector<Point2> seen_from(const Pose2& place, std::vector<Point2> points) {
    for (Point2& point : points) point = transform(inverse(place), point);
    return points;
}

std::vector<Surfel> surfels_around(const std::vector<Point2>& points) { return surfels_of({&points, 1}); }

TEST(Surfels, LieOnTheWallAtAnyPointDensity) {
    std::mt19937 random(1);
    std::vector<Point2> points;
    for (int n = 0; n < 4000; ++n) {
        const double x = n % 4 == 0 ? uniform(random, 0.0, 4.0) : uniform(random, 0.0, 1.0);
        points.push_back({x, 7.0 + uniform(random, -0.02, 0.02)});
    }
    const auto surfels = surfels_around(points);
    EXPECT_LE(surfels.size(), 84U);
    for (const Surfel& surfel : surfels) {
        ASSERT_TRUE(surfel.is_straight());
        EXPECT_NEAR(surfel.position.y, 7.0, 0.006);
        EXPECT_GT(std::abs(surfel.normal.y), 0.99);
    }
    EXPECT_TRUE(surfels_of({}).empty());
    EXPECT_FALSE(surfels_around(std::vector<Point2>(9, Point2{1.0, 1.0})).front().is_straight());
}

TEST(Surfels, SurfelsOfSeveralViewsUseAllPoints) {
    std::mt19937 random(7);
    const auto here = odd_room(random);
    const auto there = odd_room(random);
    auto all = here;
    all.insert(all.end(), there.begin(), there.end());
    const auto both = surfels_of(std::vector<std::vector<Point2>>{{}, here, there});
    const auto one = surfels_around(all);
    ASSERT_EQ(both.size(), one.size());
    for (std::size_t n = 0; n < one.size(); ++n) {
        EXPECT_EQ(both[n].position, one[n].position);
        EXPECT_EQ(both[n].normal, one[n].normal);
    }
}

TEST(Hypotheses, ContainTheGroundTruthAmongTheFirst) {
    std::mt19937 random(2);
    for (int round = 0; round < 20; ++round) {
        const Pose2 place{uniform(random, -2.0, 0.5), uniform(random, -1.5, 0.5), uniform(random, -3.0, 3.0)};
        const auto first = surfels_around(odd_room(random));
        const auto second = surfels_around(seen_from(place, odd_room(random)));
        const auto hypotheses = find_hypotheses(first, second, 5.0, 5, kSurfelsMax).value();
        const bool found = std::ranges::any_of(hypotheses, [&](const Pose2& pose) {
            return metres_off(pose, place) < 0.3 && degrees_off(pose, place) < 4.0;
        });
        EXPECT_TRUE(found) << "round " << round;
    }
}

TEST(Hypotheses, SearchStopsWhenTheCallbackReturnsAnError) {
    std::mt19937 random(5);
    const auto room = surfels_around(odd_room(random));
    for (const int last : {1, 2, 60, 120}) { // of 120 rotations
        int calls = 0;
        const auto stop_at_last = [&]() -> Result<> {
            return ++calls < last ? Result<>() : Error{Errc::kShuttingDown, "the server is shutting down"};
        };
        const auto found = find_hypotheses(room, room, 5.0, 5, kSurfelsMax, stop_at_last);
        ASSERT_FALSE(found) << last;
        EXPECT_EQ(found.error().code, Errc::kShuttingDown);
        EXPECT_EQ(calls, last);
    }
}

TEST(Refinement, ConvergesFromANearbyPose) {
    std::mt19937 random(3);
    const Surface first(surfels_around(odd_room(random)));
    for (int round = 0; round < 50; ++round) {
        const Pose2 place{uniform(random, -2.0, 0.5), uniform(random, -1.5, 0.5), uniform(random, -3.0, 3.0)};
        const Surface second(surfels_around(seen_from(place, odd_room(random))));
        const Pose2 start{place.x + uniform(random, -0.2, 0.2), place.y + uniform(random, -0.2, 0.2),
                          place.yaw + uniform(random, -0.07, 0.07)};
        const Pose2 refined = refine_by_icp(first, second.surfels(), start);
        EXPECT_LT(metres_off(refined, place), 0.08);
        const auto fit = fit_to_lines(first, second, refined);
        EXPECT_LT(metres_off(fit.T_first_second, place), 0.005);
        EXPECT_LT(degrees_off(fit.T_first_second, place), 0.1);
        EXPECT_LT(fit.rms, 0.01);
    }
}

TEST(Refinement, KeepsThePoseWithoutNearbySurfaces) {
    std::mt19937 random(4);
    const Surface room(surfels_around(odd_room(random)));
    const Pose2 far{50.0, 50.0, 1.0};
    EXPECT_EQ(refine_by_icp(room, room.surfels(), far), far);
    const auto fit = fit_to_lines(room, room, far);
    EXPECT_EQ(fit.T_first_second, far);
    EXPECT_EQ(fit.used, 0U);
}

TEST(Evidence, ElementInOpenSpaceOfTheOtherViewContradicts) {
    std::mt19937 random(5);
    const auto room = odd_room(random);
    const Surface surface(surfels_around(room));
    const Horizon horizon(room, {0.0, 0.0});
    const std::vector<Surfel> things = {
        {{-3.0, 1.0}, {1.0, 0.0}},  // on the wall
        {{-3.0, 1.0}, {0.0, 1.0}},  // at the same position, but perpendicular to the wall
        {{-1.5, 0.0}, {0.0, 0.0}},  // in open space
        {{-9.0, 0.0}, {0.0, 0.0}},  // behind the wall
        {{-2.88, 1.0}, {1.0, 0.0}}, // neither on the wall nor clearly in front of it
    };
    const auto evidence_for = [&](std::size_t thing) {
        return evidence_of(surface, std::vector{&horizon}, std::span(things).subspan(thing, 1), {});
    };
    EXPECT_EQ(evidence_for(0).inliers, 1U);
    EXPECT_EQ(evidence_for(2).outliers, 1U);
    const auto evidence = evidence_of(surface, std::vector{&horizon}, things, {});
    EXPECT_EQ(evidence.elements, 5U);
    EXPECT_EQ(evidence.inliers, 1U);
    EXPECT_EQ(evidence.outliers, 1U);
    EXPECT_EQ(horizon.at({-1.5, 0.0}), Horizon::Verdict::kOpen);
    EXPECT_EQ(horizon.at({-9.0, 0.0}), Horizon::Verdict::kHidden);
    EXPECT_EQ(Horizon({}, {0.0, 0.0}).at({1.0, 0.0}), Horizon::Verdict::kUnknown);
}

} // namespace
} // namespace scanloom::landmarks
