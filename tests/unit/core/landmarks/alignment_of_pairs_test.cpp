#include "core/landmarks/pair_alignment.hpp"
#include "tests/unit/core/landmarks/random_points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace scanloom::landmarks {
namespace {

using namespace testing_support;
using testing::ElementsAre;
using testing::HasSubstr;

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
        pairs.push_back({transform(T_first_second, second) + off, second, uniform(random, 0.1, 3.0)});
    }
    return pairs;
}

double weighted_squares(const std::vector<PointPair>& pairs, const Pose2& pose) {
    double squares = 0.0;
    for (const auto& [first, second, weight] : pairs) {
        squares += weight * squared_norm(first - transform(pose, second));
    }
    return squares;
}

/// Returns the best pose by a grid search over yaw with increasing resolution. For each yaw, the best translation
/// follows from the weighted means.
Pose2 searched(const std::vector<PointPair>& pairs) {
    const auto best_with = [&](double yaw) {
        double weights = 0.0;
        Point2 sum{0.0, 0.0};
        for (const auto& [first, second, weight] : pairs) {
            sum += weight * (first - transform({0.0, 0.0, yaw}, second));
            weights += weight;
        }
        return Pose2{sum.x / weights, sum.y / weights, yaw};
    };
    Pose2 best;
    double step = std::numbers::pi / 90.0;
    double centre = 0.0;
    for (int finer = 0; finer < 12; ++finer) {
        double least = std::numeric_limits<double>::infinity();
        const double middle = centre;
        for (int n = -90; n <= 90; ++n) {
            const Pose2 pose = best_with(middle + n * step);
            const double squares = weighted_squares(pairs, pose);
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
        ASSERT_LE(weighted_squares(pairs, fit.T_first_second), weighted_squares(pairs, best) * (1.0 + 1e-9));
        if (round % 2 == 0 && pairs.size() > 3) {
            ASSERT_LT(distance(fit.T_first_second, best), 1e-4);
        }
        double weights = 0.0;
        for (const auto& pair : pairs) weights += pair.weight;
        ASSERT_NEAR(fit.rms, std::sqrt(weighted_squares(pairs, fit.T_first_second) / weights), 1e-9);
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
        ASSERT_LT(distance(align_pairs(pairs)->T_first_second, pose), 1e-9);
    }
}

TEST(AlignmentOfPairs, NeverReturnsAReflection) {
    std::vector<PointPair> pairs;
    for (const Point2& second : {Point2{0.0, 0.0}, Point2{4.0, 0.0}, Point2{0.0, 1.0}}) {
        pairs.push_back({{second.x, -second.y}, second});
    }
    const auto fit = align_pairs(pairs).value();
    EXPECT_GT(fit.rms, 0.3) << "only a reflection would fit exactly";
    EXPECT_NEAR(norm(transform(fit.T_first_second, {4.0, 0.0}) - transform(fit.T_first_second, {0.0, 0.0})), 4.0,
                1e-12);
}

TEST(AlignmentOfPairs, IgnoresPairsWithoutWeight) {
    std::vector<PointPair> pairs = {{{0.0, 0.0}, {1.0, 0.0}}, {{9.0, 9.0}, {0.0, 0.0}, 0.0}, {{1.0, 0.0}, {2.0, 0.0}}};
    const auto fit = align_pairs(pairs).value();
    EXPECT_THAT(fit.used, ElementsAre(0U, 2U));
    EXPECT_LT(distance(fit.T_first_second, {-1.0, 0.0, 0.0}), 1e-12);
    EXPECT_LT(fit.rms, 1e-12);
    for (auto& pair : pairs) pair.weight *= 1e300;
    EXPECT_EQ(align_pairs(pairs)->T_first_second, fit.T_first_second) << "only ratios of weights matter";
}

/// Returns how many of 1000 sets with wrong pairs the robust alignment aligns to within `near`.
int right_of_1000(unsigned seed, std::size_t pair_count, std::size_t wrong, double near) {
    std::mt19937 random(seed);
    int right = 0;
    for (int round = 0; round < 1000; ++round) {
        const Pose2 pose = random_pose(random);
        auto pairs = random_pairs(random, pose, pair_count, 0.05);
        for (std::size_t n = 0; n < wrong; ++n) {
            pairs[2 * n].first = {uniform(random, -8.0, 8.0), uniform(random, -8.0, 8.0)};
        }
        const auto fit = align_pairs_robustly(pairs, 0.15);
        if (fit && distance(fit->T_first_second, pose) < near) ++right;
    }
    return right;
}

TEST(AlignmentOfPairs, RobustAlignmentIgnoresWrongPairs) {
    EXPECT_GE(right_of_1000(3, 20, 8, 0.1), 990) << "two of five pairs are wrong";
    EXPECT_GE(right_of_1000(5, 10, 5, 0.2), 980) << "half of 10 pairs are wrong";
}

TEST(AlignmentOfPairs, RobustAlignmentFollowsTheMajorityOrFails) {
    std::mt19937 random(6);
    for (int round = 0; round < 500; ++round) {
        const Pose2 pose = random_pose(random);
        const Pose2 wrong = compose({5.0, 0.0, 1.0}, pose);
        for (const std::size_t agreeing : {std::size_t{4}, std::size_t{5}}) {
            auto pairs = random_pairs(random, pose, 10, 0.02);
            for (PointPair& pair : pairs) pair.weight = 1.0;
            for (std::size_t n = 0; n < agreeing; ++n) pairs[2 * n].first = transform(wrong, pairs[2 * n].second);
            const auto fit = align_pairs_robustly(pairs, 0.15);
            if (agreeing == 5) {
                ASSERT_FALSE(fit) << "five pairs support each pose";
                EXPECT_EQ(fit.error().code, Errc::kAmbiguous);
            } else if (fit) {
                ASSERT_LT(distance(fit->T_first_second, pose), 0.3) << "six correct pairs against four wrong ones";
            }
        }
    }
}

TEST(AlignmentOfPairs, RobustAlignmentOfGoodPairsEqualsLeastSquares) {
    std::mt19937 random(4);
    for (int round = 0; round < 500; ++round) {
        const auto pairs = random_pairs(random, random_pose(random), 3 + random() % 8, 0.05);
        ASSERT_EQ(align_pairs_robustly(pairs, 1.0)->T_first_second, align_pairs(pairs)->T_first_second);
    }
}

TEST(AlignmentOfPairs, RefusesPairsThatDoNotDetermineAPose) {
    const PointPair pair{{1.0, 2.0}, {3.0, 4.0}};
    EXPECT_THAT(align_pairs({}).error().message, HasSubstr("pairs with weight: 0;"));
    EXPECT_THAT(align_pairs(std::vector{pair}).error().message, HasSubstr("pairs with weight: 1;"));
    EXPECT_THAT(align_pairs(std::vector(5, pair)).error().message, HasSubstr("no rotation"));
    const std::vector<PointPair> one_place = {
        {{1.0 / 3.0, 7.1}, {0.0, 0.0}}, {{1.0 / 3.0, 7.1}, {1.0, 0.0}}, {{1.0 / 3.0, 7.1}, {0.0, 5.0}}};
    EXPECT_THAT(align_pairs(one_place).error().message, HasSubstr("no rotation"));
    const std::vector<PointPair> mirrored = {
        {{1.0, 0.0}, {1.0, 0.0}}, {{-1.0, 0.0}, {-1.0, 0.0}}, {{0.0, -1.0}, {0.0, 1.0}}, {{0.0, 1.0}, {0.0, -1.0}}};
    EXPECT_THAT(align_pairs(mirrored).error().message, HasSubstr("no rotation"));
    const std::vector<PointPair> apart = {
        {{0.0, 0.0}, {0.0, 0.0}}, {{1.0, 0.0}, {9.0, 0.0}}, {{0.0, 1.0}, {0.0, 30.0}}};
    EXPECT_FALSE(align_pairs_robustly(apart, 0.1)) << "no three pairs agree";
}

TEST(AlignmentOfPairs, RefusesInvalidPairs) {
    const std::vector<PointPair> good = {{{0.0, 0.0}, {0.0, 0.0}}, {{1.0, 0.0}, {1.0, 0.0}}, {{0.0, 1.0}, {0.0, 1.0}}};
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
        auto pairs = good;
        pairs[1].weight = bad;
        EXPECT_THAT(align_pairs(pairs).error().message, HasSubstr("pairs[1].weight"));
        pairs = good;
        pairs[2].first.x = bad;
        EXPECT_THAT(align_pairs(pairs).error().message, HasSubstr("pairs[2].first"));
        EXPECT_THAT(align_pairs_robustly(pairs, 0.1).error().message, HasSubstr("pairs[2].first"));
        pairs = good;
        pairs[0].second.y = bad;
        EXPECT_THAT(align_pairs(pairs).error().message, HasSubstr("pairs[0].second"));
        EXPECT_THAT(align_pairs_robustly(good, bad).error().message, HasSubstr("inlier_distance"));
    }
    auto pairs = good;
    pairs[0].weight = -1.0;
    EXPECT_FALSE(align_pairs(pairs));
    EXPECT_FALSE(align_pairs_robustly(good, 0.0));
}

} // namespace
} // namespace scanloom::landmarks
