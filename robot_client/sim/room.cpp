#include "robot_client/sim/world.hpp"

namespace scanloom::robot {

// 10 x 10 m inside, around the world's origin. Furniture leaves either no gap or one that a robot fits through.
World make_room() {
    std::vector<Box> solids = {
        // walls, 0.2 m thick
        {-5.2, -5.2, 5.2, -5.0},
        {-5.2, 5.0, 5.2, 5.2},
        {-5.2, -5.2, -5.0, 5.2},
        {5.0, -5.2, 5.2, 5.2},
        // against the walls, shallow: a wardrobe, a sideboard, a bookcase, a shelf
        {-5.0, 0.8, -4.5, 2.8},
        {0.5, 4.6, 2.9, 5.0},
        {4.65, -1.5, 5.0, 0.5},
        {-4.2, -5.0, -2.4, -4.65},
        // free-standing, with wide passages around them: a table, a sofa, a pillar, an armchair, a bed
        {-1.2, -0.6, 0.8, 0.4},
        {-1.8, 1.8, 0.2, 2.6},
        {2.0, 1.2, 2.4, 1.6},
        {1.6, -2.2, 2.4, -1.4},
        {-2.6, -2.8, -0.6, -1.4},
    };
    return make_world("room", std::move(solids), {{-5.0, -5.0, 5.0, 5.0}});
}

World make_room_walker() {
    World world = make_room();
    world.name = "room_walker";
    world.walkers = {{.loop = {{-3.0, -3.3}, {3.1, -3.3}, {3.1, 3.2}, {-3.0, 3.2}}}};
    return world;
}

} // namespace scanloom::robot
