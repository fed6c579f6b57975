#include "sim/world.hpp"

#include "sim/ground_truth.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace scanloom::sim {
namespace {

TEST(FindWorld, UnknownNameListsTheWorlds) {
    EXPECT_EQ(find_world("moon").error().message, "unknown world 'moon'; choose room, room_walker, office or hall");
}

TEST(FindWorld, WorldsAreFoundByName) {
    for (const NamedWorld& world : kWorlds) EXPECT_EQ(find_world(world.name)->name, world.name);
}

TEST(Hall, IsSixtyByFortyMetres) {
    const GroundTruthGrid grid = ground_truth_of(make_hall(), 0.1);
    EXPECT_EQ(grid.width, 606);
    EXPECT_EQ(grid.height, 406);
    EXPECT_EQ(make_hall().floors.at(0), (Box{-30.0, -20.0, 30.0, 20.0}));
}

TEST(Hall, GapsBetweenBoxesAreWideEnoughForARobot) {
    const World hall = make_hall();
    for (const Box& a : hall.solids) {
        for (const Box& b : hall.solids) {
            const double dx = std::max({a.x_min - b.x_max, b.x_min - a.x_max, 0.0});
            const double dy = std::max({a.y_min - b.y_max, b.y_min - a.y_max, 0.0});
            const double gap = std::hypot(dx, dy);
            EXPECT_TRUE(gap == 0.0 || gap > 1.2 - 1e-9) << gap << " m between the boxes at " << a.x_min << ' '
                                                        << a.y_min << " and " << b.x_min << ' ' << b.y_min;
        }
    }
}

} // namespace
} // namespace scanloom::sim
