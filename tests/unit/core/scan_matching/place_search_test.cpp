#include "core/scan_matching/place_search.hpp"
#include "core/scan_matching/seen_space.hpp"
#include "tests/support/building.hpp"
#include "tests/support/uniform.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <span>

namespace scanloom::scan_matching {
namespace {

using testing_support::Building;
using testing_support::uniform;

constexpr double kCell = 0.1; // metres
constexpr int kTurns = 960;

/// A room with some boxes, a map of it from three views, and a scan from elsewhere in it.
struct SearchedRoom {
    SearchedRoom(std::mt19937& random, double size, std::size_t count = 14) {
        building.add_box(-uniform(random, 0.4, 0.6) * size, -0.4 * size, 0.5 * size, uniform(random, 0.3, 0.5) * size);
        for (int n = 0; n < 3; ++n) {
            const double x = uniform(random, -0.35, 0.3) * size;
            const double y = uniform(random, -0.3, 0.25) * size;
            building.add_box(x, y, x + uniform(random, 0.05, 0.1) * size, y + 0.1 * size);
        }
        for (int n = 0; n < 3; ++n) {
            const Pose2 pose = place(random, size);
            shown.push_back(points_of(building.scan(laser, pose, 0.01, random), laser));
            poses.push_back(transform_of(pose));
        }
        for (std::size_t n = 0; n < shown.size(); ++n) views.push_back({poses[n], shown[n].points});
        truth = transform_of(place(random, size));
        const auto scan = points_of(building.scan(laser, pose_of(truth), 0.01, random), laser).points;
        for (std::size_t n = 0; n < count; ++n) points.push_back(scan[n * scan.size() / count]);
    }

    static Pose2 place(std::mt19937& random, double size) {
        return {uniform(random, -0.3, 0.3) * size, uniform(random, -0.2, 0.2) * size, uniform(random, -3.1, 3.1)};
    }

    Building building;
    Sensor laser = Building::laser();
    std::vector<ScanPoints> shown;
    std::vector<Transform2> poses;
    std::vector<View> views;
    Transform2 truth;
    std::vector<SurfacePoint> points;
};

std::shared_ptr<const PlaceMap> map_of(std::span<const View> views) { return std::make_shared<const PlaceMap>(views); }

std::optional<FoundPlace> find(const std::shared_ptr<const PlaceMap>& map, std::span<const SurfacePoint> points,
                               const PlaceQuestion& question) {
    PlaceSearch search(map, points, question);
    EXPECT_TRUE(search.run());
    return search.place();
}

bool is_apart(const Transform2& a, const Transform2& b) {
    const Transform2 off = inverse(a) * b;
    return distance_of(off) > PlaceSearch::kApart || std::fabs(yaw_of(off)) > PlaceSearch::kTurnApart;
}

TEST(PlaceSearch, FindsWhatTryingAllPlacesFinds) {
    std::mt19937 random(1);
    for (int round = 0; round < 2; ++round) {
        SearchedRoom scene(random, 2.5);
        for (SurfacePoint& point : scene.points) { // so that few places are the best
            point.x += static_cast<float>(uniform(random, -0.15, 0.15));
            point.y += static_cast<float>(uniform(random, -0.15, 0.15));
        }
        const auto map = map_of(scene.views);
        const SeenSpace space(scene.views);
        const PlaceQuestion question{.score_min = 6, .rival_share = 0.8};
        const auto found = find(map, scene.points, question);
        ASSERT_TRUE(found);
        EXPECT_EQ(map->score_of(scene.points, found->T_map_points), found->score);
        int best = 0;
        int rival = 0;
        for (int turn = 0; turn < kTurns; ++turn) {
            const SinCos rotation = sin_cos((turn + 0.5) * 2.0 * std::numbers::pi / kTurns - std::numbers::pi);
            for (int row = -20; row <= 20; ++row) {
                for (int column = -20; column <= 20; ++column) {
                    const Transform2 pose{found->T_map_points.x + column * kCell, found->T_map_points.y + row * kCell,
                                          rotation};
                    if (!space.is_free(pose.x, pose.y)) continue;
                    const int score = map->score_of(scene.points, pose);
                    best = std::max(best, score);
                    if (score > rival && is_apart(found->T_map_points, pose)) rival = score;
                }
            }
        }
        EXPECT_EQ(found->score, best);
        EXPECT_LE(rival, std::max(found->rival_score, static_cast<int>(question.rival_share * best)));
    }
}

/// Whether a point matches a map, by comparing it with all points of the map.
enum class Matches { kNo, kPerhaps, kYes };

/// Cells are 10 cm wide, and a cell matches for the points in it and in its neighbours. A surface matches for normals
/// up to 0.5 rad from its own, and in the whole of the eighth turns that these lie in.
Matches matches(const SurfacePoint& point, std::span<const SurfacePoint> map) {
    constexpr double kRounding = 1e-4; // metres and radians
    Matches result = Matches::kNo;
    for (const SurfacePoint& other : map) {
        const double apart = std::max(std::fabs(point.x - other.x), std::fabs(point.y - other.y));
        if (apart > 2.0 * kCell + kRounding) continue;
        double turn = 0.0;
        if (point.has_normal() && other.has_normal()) {
            turn = std::fabs(normalize_angle(direction_of(point) - direction_of(other)));
        }
        if (apart < kCell - kRounding && turn < 0.5 - kRounding) return Matches::kYes;
        if (turn < 0.5 + std::numbers::pi / 4.0 + kRounding) result = Matches::kPerhaps;
    }
    return result;
}

TEST(PlaceSearch, AScoreCountsPointsNearSurfacesMinusThoseInSeenSpace) {
    std::mt19937 random(2);
    SearchedRoom scene(random, 8.0, 30);
    const Transform2 T_map_room = transform_of({0.0, 0.0, 0.4}); // so that walls face the middle of an eighth turn
    for (View& view : scene.views) view.T_map_robot = T_map_room * view.T_map_robot;
    const auto map = map_of(scene.views);
    const SeenSpace space(scene.views);
    std::vector<SurfacePoint> shown;
    for (const View& view : scene.views) {
        for (const SurfacePoint& point : view.points) shown.push_back(transform(view.T_map_robot, point));
    }
    int matched = 0;
    int contradicted = 0;
    int undecided = 0;
    constexpr int kRounds = 300;
    for (int round = 0; round < kRounds; ++round) {
        const Transform2 off =
            transform_of({uniform(random, -0.3, 0.3), uniform(random, -0.3, 0.3), uniform(random, -0.6, 0.6)});
        const Transform2 anywhere = transform_of(SearchedRoom::place(random, 8.0));
        const Transform2 pose = T_map_room * (round % 2 == 0 ? scene.truth * off : anywhere);
        int low = 0;
        int high = 0;
        for (const SurfacePoint& point : scene.points) {
            const SurfacePoint moved = transform(pose, point);
            const int without = space.is_free(moved.x, moved.y) ? -1 : 0;
            const Matches found = matches(moved, shown);
            low += found == Matches::kYes ? 1 : without;
            high += found == Matches::kNo ? without : 1;
            matched += found == Matches::kYes ? 1 : 0;
            contradicted -= without;
            undecided += found == Matches::kPerhaps ? 1 : 0;
        }
        const int score = map->score_of(scene.points, pose);
        ASSERT_LE(low, score);
        ASSERT_GE(high, score);
    }
    EXPECT_GT(matched, 300);
    EXPECT_GT(contradicted, 1000);
    EXPECT_LT(undecided, 1200) << "so that the bounds are close to each other";
}

TEST(PlaceSearch, FindsAScanInABuildingWithoutAnEstimate) {
    std::mt19937 random(3);
    int found_count = 0;
    for (int round = 0; round < 20; ++round) {
        const SearchedRoom scene(random, 12.0, 60);
        const auto found = find(map_of(scene.views), scene.points, {.score_min = 48});
        if (!found || found->rival_score > 0.9 * found->score) continue;
        ++found_count;
        EXPECT_FALSE(is_apart(found->T_map_points, scene.truth)) << round;
    }
    EXPECT_GT(found_count, 3) << "of those that are not like another place";
}

/// In rooms that are too large to try all places: those around the truth.
TEST(PlaceSearch, NoPlaceAroundTheTruthIsBetter) {
    std::mt19937 random(7);
    for (int round = 0; round < 40; ++round) {
        const SearchedRoom scene(random, 12.0, 40);
        const auto map = map_of(scene.views);
        const SeenSpace space(scene.views);
        int best = 0;
        const auto found = find(map, scene.points, {.score_min = 1, .rival_share = 1.0});
        ASSERT_TRUE(found);
        const double turn = 2.0 * std::numbers::pi / kTurns;
        const auto middle = std::floor((yaw_of(scene.truth) + std::numbers::pi) / turn);
        for (int k = -8; k <= 8; ++k) {
            const SinCos rotation = sin_cos((middle + k + 0.5) * turn - std::numbers::pi);
            for (int j = -4; j <= 4; ++j) {
                for (int i = -4; i <= 4; ++i) { // on the grid of the result
                    const auto on_grid = [&](double at, double of) {
                        return of + std::floor((at - of) / kCell) * kCell;
                    };
                    const Transform2 pose{on_grid(scene.truth.x, found->T_map_points.x) + i * kCell,
                                          on_grid(scene.truth.y, found->T_map_points.y) + j * kCell, rotation};
                    if (space.is_free(pose.x, pose.y)) best = std::max(best, map->score_of(scene.points, pose));
                }
            }
        }
        EXPECT_GE(found->score, best) << round;
    }
}

TEST(PlaceSearch, EqualRoomsAreRivals) {
    std::mt19937 random(4);
    const SearchedRoom scene(random, 6.0);
    std::vector<View> twice = scene.views;
    for (View view : scene.views) {
        view.T_map_robot.x += 20.0;
        twice.push_back(view);
    }
    const auto found = find(map_of(twice), scene.points, {.score_min = 8});
    ASSERT_TRUE(found);
    EXPECT_GE(found->rival_score, found->score - 2) << "the second room starts at another part of a cell";
}

TEST(PlaceSearch, ASearchInPartsFindsWhatOneAtOnceFinds) {
    std::mt19937 random(5);
    const SearchedRoom scene(random, 8.0, 40);
    const auto map = map_of(scene.views);
    const PlaceQuestion question{.score_min = 20};
    const auto at_once = find(map, scene.points, question);
    ASSERT_TRUE(at_once);
    PlaceSearch search(map, scene.points, question);
    std::size_t parts = 1;
    while (!search.run(5000 * parts)) ++parts;
    EXPECT_GT(parts, 3U);
    EXPECT_EQ(search.place()->T_map_points, at_once->T_map_points);
    EXPECT_EQ(search.place()->score, at_once->score);
    EXPECT_EQ(search.place()->rival_score, at_once->rival_score);
    EXPECT_TRUE(search.run(1)) << "it has ended";
}

TEST(PlaceSearch, AnEmptyMapAndNoPointsHaveNoPlace) {
    std::mt19937 random(6);
    const SearchedRoom scene(random, 4.0);
    EXPECT_FALSE(find(map_of({}), scene.points, {}));
    EXPECT_FALSE(find(map_of(scene.views), {}, {}));
}

} // namespace
} // namespace scanloom::scan_matching
