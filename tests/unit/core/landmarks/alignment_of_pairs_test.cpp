#include "core/landmarks/refinement.hpp"
#include "tests/unit/core/landmarks/random_points.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace scanloom::landmarks {
namespace {

using namespace testing_support;

Pose2 random_pose(std::mt19937& random) {
    return {uniform(random, -5.0, 5.0), uniform(random, -5.0, 5.0), uniform(random, -3.14, 3.14)};
}

/// Returns pairs that fit a pose except for some noise.
std::vector<PointPair> random_pairs(std::mt19937& random, const Pose2& T_first_second, std::size_t count,
                                    double noise) {
    std::vector<PointPair> pairs;
    for (std::size_t n = 0; n < count; ++n) {
        const Point2 second{uniform(random, -5.0, 5.0), uniform(random, -5.0, 5.0)};
        const Point2 off{uniform(random, -noise, noise), uniform(random, -noise, noise)};
        pairs.push_back({transform(T_first_second, second) + off, second});
    }
    return pairs;
}

double squares_of(const std::vector<PointPair>& pairs, const Pose2& pose) {
    double squares = 0.0;
    for (const auto& [first, second] : pairs) squares += squared_norm(first - transform(pose, second));
    return squares;
}

/// Returns the best pose by a grid search over yaw with increasing resolution. For each yaw, the best translation
/// follows from the means.
Pose2 searched(const std::vector<PointPair>& pairs) {
    const auto best_with = [&](double yaw) {
        Point2 sum{0.0, 0.0};
        for (const auto& [first, second] : pairs) sum += first - transform({0.0, 0.0, yaw}, second);
        sum /= static_cast<double>(pairs.size());
        return Pose2{sum.x, sum.y, yaw};
    };
    Pose2 best;
    double step = std::numbers::pi / 90.0;
    double centre = 0.0;
    for (int finer = 0; finer < 12; ++finer) {
        double least = std::numeric_limits<double>::infinity();
        const double middle = centre;
        for (int n = -90; n <= 90; ++n) {
            const Pose2 pose = best_with(middle + n * step);
            const double squares = squares_of(pairs, pose);
            if (squares >= least) continue;
            least = squares;
            best = pose;
            centre = pose.yaw;
        }
        step /= 20.0;
    }
    best.yaw = normalize_angle(best.yaw);
    return best;
}

double distance(const Pose2& a, const Pose2& b) {
    return std::hypot(a.x - b.x, a.y - b.y) + std::abs(normalize_angle(a.yaw - b.yaw));
}

TEST(AlignmentOfPairs, MatchesAFineGridSearch) {
    std::mt19937 random(1);
    for (int round = 0; round < 2000; ++round) {
        const auto pairs = random_pairs(random, random_pose(random), 2 + random() % 8, round % 2 == 0 ? 0.3 : 3.0);
        const auto fit = align_pairs(pairs).value();
        const Pose2 best = searched(pairs);
        ASSERT_LE(squares_of(pairs, fit), squares_of(pairs, best) * (1.0 + 1e-9));
        if (round % 2 == 0 && pairs.size() > 3) {
            ASSERT_LT(distance(fit, best), 1e-4);
        }
    }
}

TEST(AlignmentOfPairs, FindsAnExactTransformFromTwoPairsOrCollinearPoints) {
    std::mt19937 random(2);
    for (int round = 0; round < 500; ++round) {
        const Pose2 pose = random_pose(random);
        std::vector<PointPair> pairs;
        for (int n = 0; n < 2 + round % 4; ++n) {
            const Point2 second{1.0 + n, 2.0 + 0.5 * n};
            pairs.push_back({transform(pose, second), second});
        }
        ASSERT_LT(distance(align_pairs(pairs).value(), pose), 1e-9);
    }
}

TEST(AlignmentOfPairs, NeverReturnsAReflection) {
    std::vector<PointPair> pairs;
    for (const Point2& second : {Point2{0.0, 0.0}, Point2{4.0, 0.0}, Point2{0.0, 1.0}}) {
        pairs.push_back({{second.x, -second.y}, second});
    }
    const auto fit = align_pairs(pairs).value();
    EXPECT_GT(squares_of(pairs, fit), 0.27) << "only a reflection would fit exactly";
    EXPECT_NEAR(norm(transform(fit, {4.0, 0.0}) - transform(fit, {0.0, 0.0})), 4.0, 1e-12);
}

TEST(AlignmentOfPairs, FindsNothingIfThePairsDoNotDetermineAPose) {
    const PointPair pair{{1.0, 2.0}, {3.0, 4.0}};
    EXPECT_FALSE(align_pairs({}));
    EXPECT_FALSE(align_pairs(std::vector{pair}));
    EXPECT_FALSE(align_pairs(std::vector(5, pair)));
    const std::vector<PointPair> one_place = {
        {{1.0 / 3.0, 7.1}, {0.0, 0.0}}, {{1.0 / 3.0, 7.1}, {1.0, 0.0}}, {{1.0 / 3.0, 7.1}, {0.0, 5.0}}};
    EXPECT_FALSE(align_pairs(one_place));
    const std::vector<PointPair> mirrored = {
        {{1.0, 0.0}, {1.0, 0.0}}, {{-1.0, 0.0}, {-1.0, 0.0}}, {{0.0, -1.0}, {0.0, 1.0}}, {{0.0, 1.0}, {0.0, -1.0}}};
    EXPECT_FALSE(align_pairs(mirrored));
}

} // namespace
} // namespace scanloom::landmarks
