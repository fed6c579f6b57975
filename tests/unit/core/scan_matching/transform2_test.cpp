#include "core/scan_matching/transform2.hpp"
#include "tests/support/building.hpp"
#include "tests/support/uniform.hpp"

#include <gtest/gtest.h>

#include <bit>

namespace scanloom::scan_matching {
namespace {

using testing_support::uniform;

TEST(Transform2, SineAndCosineAreThoseOfTheCLibraryUpToRounding) {
    std::mt19937 random(1);
    for (int n = 0; n < 100000; ++n) {
        const double angle = n < 9 ? (n - 4) * std::numbers::pi / 4.0 : uniform(random, -20.0, 20.0);
        const SinCos found = sin_cos(angle);
        ASSERT_NEAR(found.sin, std::sin(angle), 1e-15) << angle;
        ASSERT_NEAR(found.cos, std::cos(angle), 1e-15) << angle;
    }
}

TEST(Transform2, AngleOfAVectorIsThatOfTheCLibraryUpToRounding) {
    std::mt19937 random(2);
    for (int n = 0; n < 100000; ++n) {
        const double scale = std::ldexp(1.0, static_cast<int>(random() % 40) - 20);
        const double x = n < 25 ? n % 5 - 2 : uniform(random, -scale, scale);
        const double y = n < 25 ? n / 5 - 2 : uniform(random, -1.0, 1.0);
        ASSERT_NEAR(angle_of(y, x), std::atan2(y, x), 1e-15) << y << ", " << x;
    }
}

TEST(Transform2, ComposesAndInvertsAsPosesDo) {
    std::mt19937 random(3);
    for (int n = 0; n < 10000; ++n) {
        const Pose2 a{uniform(random, -100.0, 100.0), uniform(random, -100.0, 100.0), uniform(random, -3.0, 3.0)};
        const Pose2 b{uniform(random, -100.0, 100.0), uniform(random, -100.0, 100.0), uniform(random, -3.0, 3.0)};
        const Pose2 expected = compose(inverse(a), b);
        const Pose2 found = pose_of(inverse(transform_of(a)) * transform_of(b));
        ASSERT_NEAR(found.x, expected.x, 1e-12);
        ASSERT_NEAR(found.y, expected.y, 1e-12);
        ASSERT_NEAR(normalize_angle(found.yaw - expected.yaw), 0.0, 1e-14);
        const Point2 point = transform_of(a) * Point2{b.x, b.y};
        ASSERT_NEAR(point.x, transform(a, {b.x, b.y}).x, 1e-12);
        ASSERT_NEAR(point.y, transform(a, {b.x, b.y}).y, 1e-12);
    }
}

TEST(Transform2, LongChainsKeepUnitLength) {
    const Transform2 step = transform_of({0.01, 0.002, 0.0123});
    Transform2 pose;
    for (int n = 0; n < 1'000'000; ++n) pose = pose * step;
    const auto [s, c] = pose.rotation;
    EXPECT_NEAR(s * s + c * c, 1.0, 1e-15);
    EXPECT_NEAR(yaw_of(pose), std::remainder(1'000'000 * 0.0123, 2.0 * std::numbers::pi), 1e-9);
}

/// The constant is the same for every compiler, processor and instruction set.
TEST(Transform2, ResultsHaveTheSameBitsEverywhere) {
    std::mt19937 random(4);
    std::uint64_t hash = 0;
    for (int n = 0; n < 10000; ++n) {
        const auto [s, c] = sin_cos(uniform(random, -10.0, 10.0));
        for (const double value : {s, c, angle_of(s, c)})
            hash = hash * 0x100'0000'01B3U ^ std::bit_cast<std::uint64_t>(value);
    }
    EXPECT_EQ(hash, 13505532519383004812U);
}

} // namespace
} // namespace scanloom::scan_matching
