#include "core/landmarks/localization.hpp"
#include "tests/support/angles.hpp"
#include "tests/support/located_robot.hpp"
#include "tests/support/standing_robot.hpp"
#include "tests/unit/core/landmarks/pose_errors.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace scanloom::landmarks {
namespace {

using namespace testing_support;
using sim::Box;
using testing::HasSubstr;

void expect_right(const Alignment& found, const Pose2& ground_truth, const std::string& where = "") {
    EXPECT_EQ(found.certainty, Certainty::kClear) << where << ": " << found.why;
    EXPECT_LT(metres_off(found.T_first_second, ground_truth), 0.02) << where;
    EXPECT_LT(degrees_off(found.T_first_second, ground_truth), 0.5) << where;
}

/// Returns the number of clear localizations and expects each of them to be correct.
int clear_of(const sim::World& world, int seeds, int places) {
    int clear = 0;
    for (int seed = 0; seed < seeds; ++seed) {
        const auto mapped = mapped_world(world, places, static_cast<std::uint64_t>(seed));
        const auto found = locate(as_references(mapped.map), {.points = mapped.seen}).value();
        EXPECT_EQ(found.why.empty(), found.certainty == Certainty::kClear);
        if (found.certainty != Certainty::kClear) continue;
        ++clear;
        expect_right(found, mapped.ground_truth, world.name + ", seed " + std::to_string(seed));
        EXPECT_LT(metres_off(found.T_first_second, mapped.ground_truth), 6.0 * found.position_sigma);
        EXPECT_GT(found.inlier_ratio, 0.5);
    }
    return clear;
}

/// Some of the scenes of LocalizationTrials.
TEST(Localization, LocalizesInARoomAndInAnOffice) {
    EXPECT_EQ(clear_of(sim::make_room(), 2, 3), 2);
    EXPECT_GE(clear_of(sim::make_office(), 2, 6), 1);
}

TEST(LocalizationTrials, LocalizesInARoomWithoutPrior) { EXPECT_GE(clear_of(sim::make_room(), 20, 3), 19); }

TEST(LocalizationTrials, LocalizesInAnOfficeOrReportsAmbiguity) {
    auto office = sim::make_office();
    office.starts = {{-15.0, -10.0, 15.0, 10.0}};
    EXPECT_GE(clear_of(office, 12, 6), 10);
}

TEST(LocalizationTrials, LocalizesInAHallOrReportsAmbiguity) { EXPECT_GE(clear_of(sim::make_hall(), 10, 6), 4); }

/// Two equal rooms are 20 m apart; one is mapped from twenty places and the other from two. Walls that were observed
/// more often are drawn thicker, and an earlier locate() returned a pose in the wrong room.
TEST(Localization, IsAmbiguousInEqualRoomsOfDifferentMappingDensity) {
    std::vector<Box> solids;
    for (const double x : {-10.0, 10.0}) {
        for (const Box& wall :
             {Box{x - 3.0, -2.5, x + 3.0, -2.0}, Box{x - 3.0, 2.0, x + 3.0, 2.5}, Box{x - 3.0, -2.5, x - 2.5, 2.5},
              Box{x + 2.5, -2.5, x + 3.0, 2.5}, Box{x + 1.0, 1.2, x + 2.5, 2.0}}) {
            solids.push_back(wall);
        }
    }
    const auto world = sim::make_world("rooms", solids, {{-12.0, -1.5, -8.0, 1.0}, {8.0, -1.5, 12.0, 1.0}});
    for (unsigned seed = 1; seed <= 4; ++seed) {
        sim::Random random(seed);
        const auto place_in = [&](double x) {
            return Pose2{x + random.uniform(-1.5, 1.5), random.uniform(-1.0, 1.0), random.uniform(-3.0, 3.0)};
        };
        ReferenceViews map;
        for (int n = 0; n < 20; ++n) map.push_back(reference_view(world, place_in(-10.0), random));
        for (int n = 0; n < 2; ++n) map.push_back(reference_view(world, place_in(10.0), random));
        const auto seen = sim::standing_capture(world, place_in(10.0), 10, random);
        const auto found = locate(map, {.points = seen}).value();
        EXPECT_EQ(found.certainty, Certainty::kAmbiguous) << "seed " << seed << ": " << found.why;
    }
}

/// A random scene on which an earlier locate() was wrong.
struct HardScene {
    sim::World world;
    int places;
    std::uint64_t seed;
};

/// The map has no surface behind the robot. An earlier locate() considered this place impossible and returned the next
/// best one.
TEST(Localization, LocalizesWithoutSurfacesBehindTheRobot) {
    for (const auto& [world, places, seed] : {HardScene{sim::make_hall(), 1, 123}, {sim::make_hall(), 4, 168}}) {
        const auto mapped = mapped_world(world, places, seed);
        expect_right(locate(as_references(mapped.map), {.points = mapped.seen}).value(), mapped.ground_truth,
                     world.name + ", seed " + std::to_string(seed));
    }
}

/// The correct place is mapped only in part, and a similar place is mapped completely.
TEST(Localization, IsAmbiguousIfASimilarPlaceIsMappedBetter) {
    auto office = sim::make_office();
    office.starts = {{-15.0, -10.0, 15.0, 10.0}};
    for (const auto& [world, places, seed] : {HardScene{office, 12, 101}, {sim::make_hall(), 1, 144}}) {
        const auto mapped = mapped_world(world, places, seed);
        const auto found = locate(as_references(mapped.map), {.points = mapped.seen}).value();
        EXPECT_EQ(found.certainty, Certainty::kAmbiguous) << world.name << ", seed " << seed;
        EXPECT_GT(metres_off(found.T_first_second, mapped.ground_truth), 1.0)
            << "the scene no longer leads to a wrong pose";
        EXPECT_THAT(found.why, HasSubstr("another pose"));
    }
}

/// Returns a wide room with furniture that distinguishes its corners, plus additional `things`.
sim::World furnished(std::vector<Box> things = {}) {
    things.insert(things.end(), {{-4.0, -4.0, 4.0, -3.0},
                                 {-4.0, 2.5, 4.0, 3.5},
                                 {-4.0, -4.0, -3.5, 3.5},
                                 {3.5, -4.0, 4.0, 3.5},
                                 {-3.5, -3.0, -2.5, -2.4},
                                 {1.0, 2.0, 2.2, 2.5}});
    return sim::make_world("furnished", std::move(things), {{-3.4, -2.9, 3.4, 2.4}});
}

ReferenceViews map_of(const sim::World& world, const std::vector<Pose2>& places) {
    sim::Random random(3);
    ReferenceViews map;
    for (const Pose2& place : places) map.push_back(reference_view(world, place, random));
    return map;
}

const std::vector<Pose2> kPlaces = {{0.0, 0.0, 0.0}, {-2.0, 1.0, 1.0}, {2.0, -1.0, 2.0}};
constexpr Pose2 kGroundTruth{1.0, 0.7, -2.0};

std::vector<Point2> seen_at(const sim::World& world, const Pose2& place) {
    sim::Random random(4);
    return standing_capture(world, place, 10, random);
}

/// Returns a room around the origin that is empty.
sim::World empty_room(double half_width, double half_height) {
    return sim::make_world("empty",
                           {{-half_width - 1.0, -half_height - 1.0, half_width + 1.0, -half_height},
                            {-half_width - 1.0, half_height, half_width + 1.0, half_height + 1.0},
                            {-half_width - 1.0, -half_height - 1.0, -half_width, half_height + 1.0},
                            {half_width, -half_height - 1.0, half_width + 1.0, half_height + 1.0}},
                           {{-half_width, -half_height, half_width, half_height}});
}

TEST(Localization, IsAmbiguousByAQuarterTurnInASquareRoom) {
    const auto room = empty_room(3.0, 3.0);
    const auto found = locate(map_of(room, {{0.5, 0.2, 0.3}}), {.points = seen_at(room, {-0.4, 0.6, 2.0})}).value();
    EXPECT_EQ(found.certainty, Certainty::kAmbiguous);
    EXPECT_THAT(found.why, HasSubstr("another pose"));
    ASSERT_TRUE(found.competing_pose);
    const double turn = degrees_off(*found.competing_pose, found.T_first_second);
    EXPECT_NEAR(std::remainder(turn, 90.0), 0.0, 1.0);
    EXPECT_GT(turn, 80.0);
}

TEST(Localization, IsAmbiguousAlongACorridor) {
    const auto corridor = empty_room(40.0, 1.0);
    const auto found =
        locate(map_of(corridor, {{0.0, 0.2, 0.3}}), {.points = seen_at(corridor, {1.0, -0.2, 2.0})}).value();
    EXPECT_EQ(found.certainty, Certainty::kAmbiguous);
    EXPECT_NE(found.why, "");
    EXPECT_NEAR(std::abs(found.T_first_second.y), 0.2, 0.02)
        << "the position across the corridor is determined except for a rotation by half a turn";
}

TEST(Localization, IsDeterministic) {
    const auto map = map_of(furnished(), kPlaces);
    const auto seen = seen_at(furnished(), kGroundTruth);
    const auto once = locate(map, {.points = seen}).value();
    const auto again = locate(map, {.points = seen}).value();
    EXPECT_EQ(once.T_first_second, again.T_first_second);
    EXPECT_EQ(once.rms, again.rms);
}

TEST(Localization, ReturnsTheTransformFromTheRequestsFrame) {
    const auto world = furnished();
    const Pose2 T_odom_robot{40.0, -7.0, 1.2};
    std::vector<Point2> points;
    for (const Point2& point : seen_at(world, kGroundTruth)) points.push_back(transform(T_odom_robot, point));
    const auto found = locate(map_of(world, kPlaces), {.points = points, .from = {40.0, -7.0}}).value();
    EXPECT_EQ(found.certainty, Certainty::kClear) << found.why;
    const Pose2 robot = compose(found.T_first_second, T_odom_robot);
    EXPECT_LT(metres_off(robot, kGroundTruth), 0.02);
    EXPECT_LT(degrees_off(robot, kGroundTruth), 0.5);
}

TEST(Localization, LocalizesFarFromTheMapsOrigin) {
    const auto world = furnished();
    ReferenceViews far;
    for (const auto& view : map_of(world, kPlaces)) {
        ReferenceView moved = *view;
        moved.from += Point2{500'000.0, -300'000.0};
        for (auto& point : moved.points) point = {point.x + 500'000'000, point.y - 300'000'000};
        far.push_back(std::make_shared<const ReferenceView>(std::move(moved)));
    }
    const auto found = locate(far, {.points = seen_at(world, kGroundTruth)}).value();
    expect_right(found, {kGroundTruth.x + 500'000.0, kGroundTruth.y - 300'000.0, kGroundTruth.yaw});
}

TEST(Localization, IsAmbiguousInEqualRoomsWithoutNeighbourhood) {
    const auto world = furnished();
    auto map = map_of(world, kPlaces);
    for (const auto& view : map_of(world, kPlaces)) {
        ReferenceView other = *view;
        other.from.x += 20.0;
        for (auto& point : other.points) point.x += 20'000;
        map.push_back(std::make_shared<const ReferenceView>(std::move(other)));
    }
    const auto seen = seen_at(world, kGroundTruth);
    const auto found = locate(map, {.points = seen}).value();
    EXPECT_EQ(found.certainty, Certainty::kAmbiguous);
    EXPECT_THAT(found.why, HasSubstr("another pose, 20.0"));
    ASSERT_TRUE(found.competing_pose);
    EXPECT_NEAR(std::abs(found.competing_pose->x - found.T_first_second.x), 20.0, 0.05);

    const Neighbourhood first{{0.0, 0.0}, 5.0};
    const Neighbourhood second{{21.0, 1.0}, 5.0};
    expect_right(locate(map, {.points = seen}, first).value(), kGroundTruth, "the first");
    expect_right(locate(map, {.points = seen}, second).value(),
                 {kGroundTruth.x + 20.0, kGroundTruth.y, kGroundTruth.yaw}, "the second");
}

TEST(Localization, ExcludesPosesJustOutsideTheNeighbourhood) {
    const auto map = map_of(furnished(), kPlaces);
    const auto seen = seen_at(furnished(), kGroundTruth);
    const auto shifted_by = [&](double by) { return Neighbourhood{{kGroundTruth.x - by, kGroundTruth.y}, 2.0}; };
    expect_right(locate(map, {.points = seen}, shifted_by(1.9)).value(), kGroundTruth);
    EXPECT_NE(locate(map, {.points = seen}, shifted_by(2.1)).value().certainty, Certainty::kClear);
}

TEST(LocalizationTrials, IsNotClearInAnUnmappedPlace) {
    const auto office = sim::make_office();
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        sim::Random random(seed);
        const auto seen = standing_capture(sim::make_room(), free_place(sim::make_room(), random), 10, random);
        const auto found = locate(as_references(mapped_world(office, 8, seed).map), {.points = seen}).value();
        EXPECT_NE(found.certainty, Certainty::kClear) << "seed " << seed;
    }
}

TEST(Localization, IgnoresRemovedObjects) {
    const auto before = furnished({{-1.5, -1.8, 0.5, -1.2}, {2.4, 1.0, 3.0, 2.0}});
    const auto after = furnished();
    sim::Random random(5);
    ReferenceViews map = {reference_view(before, kPlaces[0], random)};
    for (const Pose2& place : kPlaces) map.push_back(reference_view(after, place, random));
    const auto found = locate(map, {.points = seen_at(after, kGroundTruth)}).value();
    expect_right(found, kGroundTruth);
    EXPECT_LT(found.outlier_ratio, 0.01);
}

TEST(Localization, StopsWhenTheCallbackReturnsAnError) {
    const auto map = map_of(furnished(), kPlaces);
    const auto seen = seen_at(furnished(), kGroundTruth);
    int total_calls = 0;
    ASSERT_TRUE(locate(map, {.points = seen}, {}, [&] { return ++total_calls, Result<>(); }));
    // The callback is called for views, surface elements, rotations and hypotheses. Each of these phases must stop.
    for (const int last : {1, 2, total_calls / 4, total_calls / 2, 3 * total_calls / 4, total_calls - 100,
                           total_calls - 50, total_calls - 1, total_calls}) {
        int calls = 0;
        const auto stop_at_last = [&]() -> Result<> {
            return ++calls < last ? Result<>() : Error{Errc::kShuttingDown, "the server is shutting down"};
        };
        const auto found = locate(map, {.points = seen}, {}, stop_at_last);
        ASSERT_FALSE(found) << last << " of " << total_calls;
        EXPECT_EQ(found.error().code, Errc::kShuttingDown);
        EXPECT_EQ(calls, last);
    }
}

TEST(Localization, DistinguishesAnEmptyMapFromAnUnmappedNeighbourhood) {
    const auto seen = seen_at(furnished(), kGroundTruth);
    const auto nowhere = locate({}, {.points = seen});
    ASSERT_FALSE(nowhere);
    EXPECT_EQ(nowhere.error().code, Errc::kNothingMapped);
    EXPECT_THAT(nowhere.error().message, HasSubstr("this session has no laser points yet"));

    const auto elsewhere = locate(map_of(furnished(), kPlaces), {.points = seen}, Neighbourhood{{100.0, 0.0}, 5.0});
    ASSERT_TRUE(elsewhere) << "the robot must not be localized in another mapped place";
    EXPECT_EQ(elsewhere->certainty, Certainty::kUndetermined);
    EXPECT_THAT(elsewhere->why, HasSubstr("within 5 m of (100, 0)"));
}

TEST(Localization, RequiresANeighbourhoodInATooWideMap) {
    auto map = map_of(furnished(), kPlaces);
    ReferenceView far = *map.front();
    far.from.x += 300.0;
    for (auto& point : far.points) point.x += 300'000;
    map.push_back(std::make_shared<const ReferenceView>(std::move(far)));
    const auto seen = seen_at(furnished(), kGroundTruth);
    const auto anywhere = locate(map, {.points = seen});
    ASSERT_FALSE(anywhere);
    EXPECT_EQ(anywhere.error().code, Errc::kTooLarge);
    EXPECT_THAT(anywhere.error().message, HasSubstr("307 m of the map"));
    const auto at_once = []() -> Result<> {
        ADD_FAILURE() << "the request must be refused before any work is done";
        return {};
    };
    EXPECT_FALSE(locate(map, {.points = seen}, {}, at_once));
    EXPECT_FALSE(locate(map, {.points = seen}, Neighbourhood{{0.0, 0.0}, 1000.0}, at_once));
    expect_right(locate(map, {.points = seen}, Neighbourhood{{0.0, 0.0}, 10.0}).value(), kGroundTruth);
    expect_right(locate(map, {.points = seen}, Neighbourhood{{0.0, 0.0}, 100.0}).value(), kGroundTruth);
}

TEST(Localization, RefusesInvalidViews) {
    const auto map = map_of(furnished(), kPlaces);
    EXPECT_THAT(locate(map, {.points = std::vector<Point2>(19, {1.0, 1.0})}).error().message,
                HasSubstr("the view has 19 points; 20 or more"));
    std::vector<Point2> points(30, {1.0, 1.0});
    EXPECT_THAT(locate(map, {.points = points, .from = {std::nan(""), 0.0}}).error().message,
                HasSubstr("the view.from"));
    points[7].x = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(locate(map, {.points = points}).error().message, HasSubstr("the view.points[7]"));
    // equal points do not determine a pose, independent of their number
    const auto point = locate(map, {.points = std::vector<Point2>(50, {1.0, 1.0})}).value();
    EXPECT_EQ(point.certainty, Certainty::kUndetermined);
    std::vector<Point2> line;
    for (int n = 0; n < 200; ++n) line.push_back({0.02 * n - 2.0, 1.0});
    EXPECT_NE(locate(map, {.points = line}).value().certainty, Certainty::kClear);
}

} // namespace
} // namespace scanloom::landmarks
