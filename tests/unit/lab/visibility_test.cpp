#include "lab/scoring.hpp"

#include "sim/noise.hpp"
#include "sim/ray_casting.hpp"
#include "tests/support/angles.hpp"
#include "tests/support/point_text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace scanloom::lab {
namespace {

/// Returns a corridor of 2 x 1.2 m with walls of 0.2 m and a pillar.
sim::World corridor() {
    return sim::make_world("corridor",
                           {{-0.2, -0.2, 2.2, 0.0},
                            {-0.2, 1.2, 2.2, 1.4},
                            {-0.2, -0.2, 0.0, 1.4},
                            {2.0, -0.2, 2.2, 1.4},
                            {0.8, 0.4, 1.0, 0.8}},
                           {{0.0, 0.0, 2.0, 1.2}});
}

Sensor laser(double first, double last, double range_max) {
    Sensor sensor;
    sensor.angles = UniformAngles{first, (last - first) / 100.0, 101};
    sensor.range_max = range_max;
    return sensor;
}

std::string seen_from(const Pose2& pose, const Sensor& sensor) {
    const sim::World world = corridor();
    const auto truth = sim::ground_truth_of(world, 0.2);
    const std::vector<Pose2> path{pose};
    const auto seen = visible_cells(world, truth, sensor, path, {-2, -1, 12, 7});
    std::string text;
    for (std::int32_t j = 6; j >= -1; --j) {
        for (std::int32_t i = -2; i < 12; ++i) text += seen.at({i, j}) ? 'x' : '-';
        text += '\n';
    }
    return text;
}

TEST(VisibleCells, AreInTheLineOfSight) {
    EXPECT_EQ(seen_from({0.3, 0.61, 0.0}, laser(-kPi, kPi, 5.0)), "--xxxxxxxxxx--\n"
                                                                  "-xxxxxxxxx----\n"
                                                                  "-xxxxxx-------\n"
                                                                  "-xxxxxx-------\n"
                                                                  "-xxxxxx-------\n"
                                                                  "-xxxxxx-------\n"
                                                                  "-xxxxxxxxx----\n"
                                                                  "--xxxxxxxxx---\n");
}

TEST(VisibleCells, AreWithinRangeAndFieldOfView) {
    EXPECT_EQ(seen_from({0.39, 0.61, 0.0}, laser(-kPi / 2, kPi / 2, 0.6)), "----x---------\n"
                                                                           "----xx--------\n"
                                                                           "----xxx-------\n"
                                                                           "----xxx-------\n"
                                                                           "----xxx-------\n"
                                                                           "----xxx-------\n"
                                                                           "----xx--------\n"
                                                                           "--------------\n");
}

TEST(VisibleCells, MatchRayCastingToEachFreeCell) {
    const sim::World room = sim::make_room();
    const auto truth = sim::ground_truth_of(room, 0.25);
    const std::vector<Pose2> path{{-3.9, -3.1, 0.4}, {3.3, 3.7, -2.0}};
    const auto seen = visible_cells(room, truth, laser(-kPi / 2, kPi / 2, 5.0), path, {-25, -25, 25, 25});
    for_each_cell(seen.box, [&](grid::Cell cell) {
        if (truth.at(cell.i, cell.j) != sim::GroundTruth::kFree) return;
        const Point2 centre{(cell.i + 0.5) * 0.25, (cell.j + 0.5) * 0.25};
        bool wanted = false;
        for (const Pose2& pose : path) {
            const Point2 local = transform(inverse(pose), centre);
            const double free =
                sim::cast_ray(room.outlines, {pose.x, pose.y}, std::atan2(centre.y - pose.y, centre.x - pose.x));
            wanted |= local.x > 0.0 && norm(local) < 5.0 && norm(local) < free;
        }
        EXPECT_EQ(seen.at(cell) != 0, wanted) << testing_support::text_of(centre);
    });
}

} // namespace
} // namespace scanloom::lab
