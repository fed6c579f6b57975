#include "robot_client/sim/shell.hpp"
#include "robot_client/sim/world.hpp"

namespace scanloom::robot {
namespace {

constexpr double kHallHalfWidth = 30.0; // half of the inner size
constexpr double kHallHalfHeight = 20.0;

/// Aisles that look alike: racks in the west, in two blocks. In the south block one rack is short and one is missing.
void add_racks(std::vector<Box>& solids) {
    constexpr double kDepth = 1.2;
    for (const double x : {-27.0, -23.4, -19.8, -16.2, -12.6}) solids.push_back({x, 5.0, x + kDepth, 17.0});
    for (const double x : {-27.0, -23.4, -19.8}) solids.push_back({x, -17.0, x + kDepth, -5.0});
    solids.push_back({-16.2, -17.0, -16.2 + kDepth, -9.0});
    solids.push_back({-13.2, -16.0, -10.8, -12.0}); // a machine
    solids.push_back({-30.0, -2.0, -29.4, 2.0});    // a shelf between the blocks
}

/// Nine pillars around the open floor in the middle.
void add_pillars(std::vector<Box>& solids) {
    constexpr double kHalf = 0.3;
    for (const double x : {-6.0, 2.0, 10.0}) {
        for (const double y : {-10.0, 0.0, 10.0}) solids.push_back({x - kHalf, y - kHalf, x + kHalf, y + kHalf});
    }
}

/// Seven bays along the eastern wall; some contain a trailer or its load.
void add_loading_bays(std::vector<Box>& solids) {
    constexpr double kHalfWall = 0.15;
    for (const double y : {-15.0, -9.0, -3.0, 3.0, 9.0, 15.0}) {
        solids.push_back({24.0, y - kHalfWall, kHallHalfWidth, y + kHalfWall});
    }
    solids.push_back({26.0, -13.5, kHallHalfWidth, -10.5}); // trailers
    solids.push_back({25.6, 4.5, kHallHalfWidth, 7.5});
    solids.push_back({28.4, -1.2, kHallHalfWidth, 1.2}); // a stack of boxes
    solids.push_back({24.4, 16.8, 25.6, 17.6});          // pallets
    solids.push_back({27.0, 17.0, 28.2, 17.8});
}

/// The foreman's cabin at the northern wall, with a door to the floor.
void add_cabin(std::vector<Box>& solids) {
    solids.push_back({-3.075, 15.0, -2.925, kHallHalfHeight});
    solids.push_back({3.925, 15.0, 4.075, kHallHalfHeight});
    solids.push_back({-3.075, 15.0, 0.4, 15.15});
    solids.push_back({1.6, 15.0, 4.075, 15.15});
    solids.push_back({-3.0, 18.5, -1.2, kHallHalfHeight}); // a desk
}

void add_what_stands_about(std::vector<Box>& solids) {
    solids.push_back({-8.2, -3.0, -7.0, -2.2}); // pallets
    solids.push_back({6.5, 4.2, 7.7, 5.0});
    solids.push_back({14.5, -6.5, 16.5, -5.5}); // crates around a corner
    solids.push_back({14.5, -5.5, 15.5, -3.5});
    solids.push_back({0.5, -17.5, 9.5, -16.3});              // a conveyor
    solids.push_back({17.2, 12.3, 18.4, 14.3});              // a fork-lift
    solids.push_back({13.0, -kHallHalfHeight, 15.0, -19.2}); // its charger
}

} // namespace

// 60 x 40 m inside, around the world's origin. Objects that do not touch are at least 1.2 m apart.
World make_hall() {
    std::vector<Box> solids;
    add_shell(solids, kHallHalfWidth, kHallHalfHeight);
    add_racks(solids);
    add_pillars(solids);
    add_loading_bays(solids);
    add_cabin(solids);
    add_what_stands_about(solids);
    return make_world("hall", std::move(solids),
                      {{-kHallHalfWidth, -kHallHalfHeight, kHallHalfWidth, kHallHalfHeight}});
}

} // namespace scanloom::robot
