#include "sim/map_world.hpp"

#include "sim/drive/wall_follower.hpp"
#include "sim/ground_truth.hpp"
#include "sim/ray_casting.hpp"
#include "sim/shapes.hpp"
#include "sim/simulator.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>
#include <vector>

namespace scanloom::sim {
namespace {

/// Parses rows from the top: '#' occupied, '.' free, ' ' unknown.
MapCells drawn(const std::vector<std::string_view>& rows) {
    MapCells map{rows.front().size(), {}};
    for (auto row = rows.rbegin(); row != rows.rend(); ++row) {
        for (const char c : *row) {
            map.cells.push_back(c == '#' ? MapCell::kOccupied : c == '.' ? MapCell::kFree : MapCell::kUnknown);
        }
    }
    return map;
}

MapCells random_map(Random& random, std::size_t width, std::size_t height) {
    MapCells map{width, std::vector<MapCell>(width * height)};
    const double share = random.uniform(0.0, 1.0);
    for (MapCell& cell : map.cells) {
        cell = random.uniform(0.0, 1.0) < share ? MapCell::kOccupied
                                                : static_cast<MapCell>(random.index(3)); // some cells of each kind
    }
    return map;
}

TEST(CellShapes, BoxesCoverExactlyTheCellsOfTheirKind) {
    Random random(5);
    const MapFrame frame{0.5, -3.0, 7.0};
    for (int i = 0; i < 200; ++i) {
        const MapCells map = random_map(random, 1 + random.index(20), 1 + random.index(20));
        for (const MapCell kind : {MapCell::kUnknown, MapCell::kFree, MapCell::kOccupied}) {
            const auto boxes = boxes_of(map, kind, frame);
            for (std::size_t n = 0; n < map.cells.size(); ++n) {
                const Point2 centre{frame.x(n % map.width) + 0.25, frame.y(n / map.width) + 0.25};
                const auto holding = std::ranges::count_if(boxes, [&](const Box& box) { return box.contains(centre); });
                ASSERT_EQ(holding, map.cells[n] == kind ? 1 : 0);
            }
        }
    }
}

TEST(CellShapes, RectangleIsOneBoxWithFourSides) {
    const MapCells map = drawn({".....", ".###.", ".###."});
    const MapFrame frame{1.0, 0.0, 0.0};
    EXPECT_THAT(boxes_of(map, MapCell::kOccupied, frame), testing::ElementsAre(Box{1, 0, 4, 2}));
    EXPECT_THAT(outlines_of(map, frame), testing::UnorderedElementsAre(Segment{1, 0, 4, 0}, Segment{4, 0, 4, 2},
                                                                       Segment{4, 2, 1, 2}, Segment{1, 2, 1, 0}));
}

TEST(CellShapes, OutlinesHaveSolidsOnTheirLeft) {
    Random random(6);
    const MapFrame frame{0.5, -3.0, 7.0};
    for (int i = 0; i < 100; ++i) {
        const MapCells map = random_map(random, 1 + random.index(12), 1 + random.index(12));
        const auto solids = boxes_of(map, MapCell::kOccupied, frame);
        const auto is_solid = [&](const Point2& at) {
            return std::ranges::any_of(solids, [&](const Box& box) { return box.contains(at); });
        };
        double length = 0.0;
        for (const Segment& side : outlines_of(map, frame)) {
            const Point2 a{side.ax, side.ay};
            const Point2 along = Point2{side.bx, side.by} - a;
            const Point2 left = Point2{-along.y, along.x} / norm(along) * 0.1;
            for (double at = 0.25; at < norm(along); at += 0.5) {
                const Point2 point = a + at / norm(along) * along;
                ASSERT_TRUE(is_solid(point + left));
                ASSERT_FALSE(is_solid(point - left));
            }
            length += norm(along);
        }
        double wanted = 0.0; // sides of all cells, except those between two occupied cells
        for (std::size_t n = 0; n < map.cells.size(); ++n) {
            const Point2 centre{frame.x(n % map.width) + 0.25, frame.y(n / map.width) + 0.25};
            if (!is_solid(centre)) continue;
            for (const Point2& way : {Point2{0.5, 0.0}, Point2{-0.5, 0.0}, Point2{0.0, 0.5}, Point2{0.0, -0.5}}) {
                if (!is_solid(centre + way)) wanted += 0.5;
            }
        }
        ASSERT_NEAR(length, wanted, 1e-9);
    }
}

TEST(StartCells, AreInTheLargestDrivablePart) {
    const MapCells map = drawn({
        "###################",
        "#...#.............#", // the left chamber has no exit, the right one is larger
        "#...#.............#",
        "#...#.............#",
        "#...#.............#",
        "###################",
    });
    const auto starts = start_cells(map, 1.0, 1.0, 0.5);
    ASSERT_FALSE(starts.empty());
    for (const std::size_t at : starts) {
        EXPECT_EQ(map.cells[at], MapCell::kFree);
        EXPECT_TRUE(at % map.width >= 6 && at % map.width <= 16) << at;
        EXPECT_TRUE(at / map.width == 2 || at / map.width == 3) << at;
    }
    EXPECT_EQ(starts.size(), 22U);
    EXPECT_TRUE(start_cells(map, 1.0, 5.0, 0.5).empty());
}

TEST(StartCells, HaveTheClearanceEverywhere) {
    Random random(7);
    for (int i = 0; i < 30; ++i) {
        MapCells map = random_map(random, 40, 40);
        for (MapCell& cell : map.cells) {
            if (cell == MapCell::kOccupied && random.uniform(0.0, 1.0) < 0.97) cell = MapCell::kFree;
        }
        const MapFrame frame{0.1, 0.0, 0.0};
        const Obstacles obstacles(outlines_of(map, frame), boxes_of(map, MapCell::kOccupied, frame));
        for (const std::size_t at : start_cells(map, 0.1, 0.35, 0.15)) {
            for (const double dx : {0.0, 0.1}) {
                for (const double dy : {0.0, 0.1}) {
                    const Point2 corner{frame.x(at % map.width) + dx, frame.y(at / map.width) + dy};
                    ASSERT_GE(obstacles.distance(corner), 0.35 - 1e-9);
                }
            }
        }
    }
}

const RosMapDescription kHalfMetres{.image = "m.pgm", .resolution = 0.5, .origin_x = -2.0, .origin_y = 10.0};

/// Returns a room of 5 x 4 m that is open to the right over 1 m, up to the border of the map; unknown around.
MapCells open_room() {
    return drawn({
        "  ############",
        "  #..........#",
        "  #..........#",
        "  #...........",
        "  #...........",
        "  #..........#",
        "  #..........#",
        "  ############",
    });
}

TEST(MapWorld, RaysEndOnlyAtOccupiedCells) {
    const World world = world_of_map("m", kHalfMetres, open_room()).value();
    EXPECT_EQ(world.name, "m");
    const Point2 inside{0.0, 12.0};
    EXPECT_NEAR(world.obstacles->cast_ray(inside, std::numbers::pi, 100.0), 0.5, 1e-12);
    EXPECT_NEAR(world.obstacles->cast_ray(inside, std::numbers::pi / 2.0, 100.0), 1.5, 1e-12);
    EXPECT_EQ(world.obstacles->cast_ray(inside, 0.0, 100.0), HUGE_VAL) << "the ray leaves the map";
    EXPECT_EQ(world.obstacles->cast_ray({-1.9, 13.0}, std::numbers::pi, 100.0), HUGE_VAL);
    EXPECT_NEAR(world.obstacles->cast_ray({-1.9, 13.0}, 0.0, 100.0), 0.9, 1e-12) << "the ray starts in an unknown cell";
    EXPECT_NEAR(clearance(world, inside), 0.5, 1e-12);
    EXPECT_EQ(clearance(world, {-0.75, 12.0}), 0.0) << "the point is in a wall";
    EXPECT_NEAR(clearance(world, {105.0, 12.0}), std::hypot(100.0, 0.5), 1e-9) << "the point is outside the map";
}

TEST(MapWorld, RobotsStartOnFreeCellsWithClearance) {
    const World world = world_of_map("m", kHalfMetres, open_room()).value();
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
        const Simulator simulator({world, find_laser("reference").value(), std::nullopt, seed},
                                  std::make_unique<WallFollower>());
        const Pose2 pose = simulator.pose();
        EXPECT_GE(clearance(world, {pose.x, pose.y}), kStartClearance - 1e-6);
        EXPECT_TRUE(pose.x > 0.0 && pose.x < 5.0 && pose.y > 11.0 && pose.y < 13.0);
    }
}

TEST(MapWorld, NarrowMapHasNarrowStartsAndTooNarrowMapIsRefused) {
    RosMapDescription fine = kHalfMetres;
    fine.resolution = 0.2; // the room is 2 m by 1.2 m
    const World narrow = world_of_map("m", fine, open_room()).value();
    const Simulator simulator({narrow, find_laser("reference").value(), std::nullopt, 3},
                              std::make_unique<WallFollower>());
    EXPECT_GE(clearance(narrow, {simulator.pose().x, simulator.pose().y}), 0.3 - 1e-6);
    EXPECT_LT(narrow.start_clearance, kStartClearance);
    fine.resolution = 0.05;
    const auto refused = world_of_map("m", fine, open_room());
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, testing::HasSubstr("no free place"));
}

TEST(MapWorld, GroundTruthEqualsTheMap) {
    const MapCells map = open_room();
    const GroundTruthGrid ground_truth = ground_truth_of(world_of_map("m", kHalfMetres, map).value(), 0.5);
    EXPECT_EQ(ground_truth.i_begin, -2) << "the unknown columns on the left are not included";
    EXPECT_EQ(ground_truth.j_begin, 20);
    EXPECT_EQ(ground_truth.width, 12);
    EXPECT_EQ(ground_truth.height, 8);
    for (std::int32_t j = 0; j < 8; ++j) {
        for (std::int32_t i = 0; i < 14; ++i) {
            const MapCell cell = map.cells[static_cast<std::size_t>(j * 14 + i)];
            const GroundTruth wanted = cell == MapCell::kOccupied ? GroundTruth::kOccupied
                                       : cell == MapCell::kFree   ? GroundTruth::kFree
                                                                  : GroundTruth::kOutside;
            EXPECT_EQ(ground_truth.at(i - 4, j + 20), wanted) << i << ' ' << j;
        }
    }
}

TEST(MapWorld, UnknownCellsStayUnknownNextToFreeCells) {
    const MapCells map = drawn({"......    ", "......    ", "......    ", "......    ", "......   #"});
    for (const double cell_size : {0.1, 0.5, 1.0}) {
        const GroundTruthGrid ground_truth = ground_truth_of(world_of_map("m", kHalfMetres, map).value(), cell_size);
        const auto at = [&](double x, double y) {
            return ground_truth.at(static_cast<std::int32_t>(std::floor(x / cell_size)),
                                   static_cast<std::int32_t>(std::floor(y / cell_size)));
        };
        EXPECT_EQ(at(-1.4, 10.6), GroundTruth::kFree) << cell_size;
        EXPECT_EQ(at(1.6, 11.6), GroundTruth::kOutside) << cell_size;
        EXPECT_EQ(at(2.6, 10.1), GroundTruth::kOccupied) << cell_size;
    }
}

class TruthMaps : public testing::TestWithParam<double> {};

TEST_P(TruthMaps, ConvertingToAMapAndBackKeepsTheGroundTruth) {
    for (const NamedWorld& named : kWorlds) {
        const GroundTruthGrid ground_truth = ground_truth_of(named.make(), GetParam());
        const auto map = parse_ros_yaml(ground_truth_yaml(ground_truth, "x.pgm")).value();
        const auto cells = read_ros_pgm(map, ground_truth_pgm(ground_truth)).value();
        const auto world = world_of_map("again", map, cells);
        if (!world) { // cells so large that walls leave no space
            EXPECT_GE(GetParam(), 0.5) << named.name;
            continue;
        }
        const GroundTruthGrid again = ground_truth_of(*world, GetParam());
        EXPECT_EQ(again.i_begin, ground_truth.i_begin);
        EXPECT_EQ(again.j_begin, ground_truth.j_begin);
        EXPECT_EQ(again.width, ground_truth.width);
        EXPECT_EQ(again.cells, ground_truth.cells) << named.name;
    }
}

INSTANTIATE_TEST_SUITE_P(CellSizes, TruthMaps, testing::Values(0.05, 0.1, 0.25, 0.5));

} // namespace
} // namespace scanloom::sim
