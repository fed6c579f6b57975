#include "sim/ray_casting.hpp"

#include "sim/noise.hpp"
#include "tests/support/angles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace scanloom::sim {
namespace {

constexpr double kNoHit = std::numeric_limits<double>::infinity();

/// Returns whether a point is within the cone, decided by its angle to the axis.
bool is_in(const Cone& cone, const Point2& point) {
    const Point2 to = point - cone.apex;
    return std::abs(normalize_angle(std::atan2(to.y, to.x) - cone.yaw)) <= cone.half;
}

/// Returns the smallest distance of sample points on a segment inside the cone; the samples are `step` (m) apart.
double nearest_of_points(const Cone& cone, const Segment& segment, double step) {
    const Point2 a{segment.ax, segment.ay};
    const Point2 b{segment.bx, segment.by};
    const int count = static_cast<int>(std::ceil(norm(b - a) / step)) + 1;
    double nearest = kNoHit;
    for (int n = 0; n <= count; ++n) {
        const Point2 point = a + static_cast<double>(n) / count * (b - a);
        if (is_in(cone, point)) nearest = std::min(nearest, norm(point - cone.apex));
    }
    return nearest;
}

/// Returns the smallest distance of sample points on the rim of a disc inside the cone.
double nearest_of_points(const Cone& cone, const Disc& disc, double step) {
    const int count = static_cast<int>(std::ceil(2.0 * kPi * disc.radius / step));
    double nearest = kNoHit;
    for (int n = 0; n < count; ++n) {
        const double angle = 2.0 * kPi * n / count;
        const Point2 point = disc.centre + disc.radius * Point2{std::cos(angle), std::sin(angle)};
        if (is_in(cone, point)) nearest = std::min(nearest, norm(point - cone.apex));
    }
    return nearest;
}

TEST(Cone, DistanceToAWallMatchesGeometry) {
    const Cone ahead({0.0, 0.0}, 0.0, 30.0 * kDegree);
    EXPECT_NEAR(distance_within(ahead, Segment{2.0, -1.0, 2.0, 1.0}), 2.0, 1e-12) << "the foot of the perpendicular";
    EXPECT_NEAR(distance_within(ahead, Segment{2.0, 0.2, 2.0, 1.0}), std::hypot(2.0, 0.2), 1e-12)
        << "the segment's end";
    EXPECT_NEAR(distance_within(ahead, Segment{1.0, 0.5, 3.0, 0.5}), 0.5 / std::sin(15.0 * kDegree), 1e-12)
        << "the point where the segment enters the cone";
    EXPECT_EQ(distance_within(ahead, Segment{-2.0, -1.0, -2.0, 1.0}), kNoHit) << "behind the cone";
    EXPECT_EQ(distance_within(ahead, Segment{2.0, 0.6, 2.0, 1.0}), kNoHit) << "outside the cone";
    EXPECT_EQ(distance_within(ahead, Segment{0.0, -1.0, 0.0, 1.0}), 0.0) << "through the apex";
}

TEST(Cone, DistanceToASegmentMatchesSampling) {
    constexpr double kStep = 1e-3;
    Random random(3);
    int hits = 0;
    for (int i = 0; i < 3000; ++i) {
        const Cone cone({random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)}, random.uniform(-kPi, kPi),
                        random.uniform(1.0, 170.0) * kDegree);
        const Segment segment{random.uniform(-4.0, 4.0), random.uniform(-4.0, 4.0), random.uniform(-4.0, 4.0),
                              random.uniform(-4.0, 4.0)};
        const double exact = distance_within(cone, segment);
        const double sampled = nearest_of_points(cone, segment, kStep);
        ASSERT_LE(exact, sampled + 1e-12) << i;
        if (sampled < kNoHit) {
            ASSERT_GE(exact, sampled - kStep) << i;
            ++hits;
        } else if (exact < kNoHit) { // the part inside the cone is shorter than the sample step
            const Cone wider(cone.apex, cone.yaw, 2.0 * cone.half + 4.0 * kStep / exact);
            ASSERT_LT(nearest_of_points(wider, segment, kStep / 4.0), kNoHit) << i;
        }
    }
    EXPECT_GT(hits, 1000);
}

void compare_distances_to_discs_with_sampling(int rounds) {
    constexpr double kStep = 2e-4;
    Random random(4);
    int hits = 0;
    for (int i = 0; i < rounds; ++i) {
        const Cone cone({random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)}, random.uniform(-kPi, kPi),
                        random.uniform(1.0, 170.0) * kDegree);
        const Disc disc{{random.uniform(-4.0, 4.0), random.uniform(-4.0, 4.0)}, random.uniform(0.05, 1.0)};
        if (distance(disc, cone.apex) == 0.0) {
            EXPECT_EQ(distance_within(cone, disc), 0.0);
            continue;
        }
        const double exact = distance_within(cone, disc);
        const double sampled = nearest_of_points(cone, disc, kStep);
        ASSERT_LE(exact, sampled + 1e-12) << i;
        if (sampled == kNoHit) continue; // the part inside the cone is shorter than the sample step
        ASSERT_GE(exact, sampled - kStep) << i;
        ++hits;
    }
    EXPECT_GT(hits, rounds / 4);
}

TEST(Cone, DistanceToADiscMatchesSampling) { compare_distances_to_discs_with_sampling(600); }

TEST(ConeTrials, DistanceToADiscMatchesSampling) { compare_distances_to_discs_with_sampling(5000); }

} // namespace
} // namespace scanloom::sim
