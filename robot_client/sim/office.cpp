#include "robot_client/sim/shell.hpp"
#include "robot_client/sim/world.hpp"

#include <algorithm>
#include <array>

namespace scanloom::robot {
namespace {

constexpr double kOfficeHalfWidth = 15.0; // half of the building's inner size
constexpr double kOfficeHalfHeight = 10.0;
constexpr double kCorridorOuter = 4.0;  // |y| of the wall between corridor and outer rooms
constexpr double kCorridorInner = 2.0;  // |y| of the wall between corridor and inner rooms
constexpr double kBlockHalfWidth = 9.0; // of the inner block
constexpr double kWall = 0.15;
constexpr double kDoor = 1.2;

/// Adds a wall along x, centred on `y`, with doors centred on the given positions, which must increase.
template <std::size_t N>
void add_wall_along_x(std::vector<Box>& solids, double y, double x_begin, double x_end, std::array<double, N> doors) {
    double x = x_begin;
    for (const double door : doors) {
        solids.push_back({x, y - kWall / 2, door - kDoor / 2, y + kWall / 2});
        x = door + kDoor / 2;
    }
    solids.push_back({x, y - kWall / 2, x_end, y + kWall / 2});
}

void add_wall_along_y(std::vector<Box>& solids, double x, double y_begin, double y_end) {
    solids.push_back({x - kWall / 2, y_begin, x + kWall / 2, y_end});
}

/// Five rooms of 6 x 6 m on each long side, with one door each.
void add_outer_rooms(std::vector<Box>& solids) {
    constexpr std::array<double, 5> kNorthDoors{-13.6, -7.6, -1.6, 4.4, 10.4};
    constexpr std::array<double, 5> kSouthDoors{-10.4, -4.4, 1.6, 7.6, 13.6};
    add_wall_along_x(solids, kCorridorOuter, -kOfficeHalfWidth, kOfficeHalfWidth, kNorthDoors);
    add_wall_along_x(solids, -kCorridorOuter, -kOfficeHalfWidth, kOfficeHalfWidth, kSouthDoors);
    for (const double x : {-9.0, -3.0, 3.0, 9.0}) {
        add_wall_along_y(solids, x, kCorridorOuter, kOfficeHalfHeight);
        add_wall_along_y(solids, x, -kOfficeHalfHeight, -kCorridorOuter);
    }
}

/// Three rooms of 6 x 4 m in the middle: two meeting rooms and a kitchen with doors to both corridors.
void add_inner_rooms(std::vector<Box>& solids) {
    constexpr std::array<double, 3> kNorthDoors{-7.0, 0.0, 7.0};
    constexpr std::array<double, 1> kSouthDoors{0.0};
    add_wall_along_x(solids, kCorridorInner, -kBlockHalfWidth, kBlockHalfWidth, kNorthDoors);
    add_wall_along_x(solids, -kCorridorInner, -kBlockHalfWidth, kBlockHalfWidth, kSouthDoors);
    for (const double x : {-9.0, -3.0, 3.0, 9.0}) {
        add_wall_along_y(solids, x, -kCorridorInner - kWall / 2, kCorridorInner + kWall / 2);
    }
}

void add_furniture(std::vector<Box>& solids) {
    for (const double x : {-12.0, -6.0, 0.0, 6.0, 12.0}) {
        // northern offices: two desks face to face at the window, a cabinet on the western wall
        solids.push_back({x - 0.8, 8.4, x + 0.8, 10.0});
        solids.push_back({x - 3.0, 5.6, x - 2.5, 6.8});
        // southern offices: a desk along the window, a cabinet on the eastern wall
        solids.push_back({x - 1.6, -10.0, x + 0.8, -9.2});
        solids.push_back({x + 2.5, -7.6, x + 3.0, -6.0});
    }
    solids.push_back({-7.2, -0.6, -4.8, 0.6});   // meeting table, west
    solids.push_back({4.8, -0.6, 7.2, 0.6});     // meeting table, east
    solids.push_back({-2.925, -0.4, -2.3, 1.2}); // kitchen counter
    solids.push_back({2.3, -1.2, 2.925, 0.4});   // kitchen cupboards
    solids.push_back({-12.6, -1.0, -11.4, 1.0}); // lounge table, west
    solids.push_back({11.4, -1.0, 12.6, 1.0});   // lounge table, east
    solids.push_back({-9.3, -1.0, -9.075, 1.0}); // shelves on the block's ends
    solids.push_back({9.075, -1.0, 9.3, 1.0});
}

} // namespace

// 30 x 20 m inside, around the world's origin: a ring of corridors, wider at its ends, around a block of inner rooms.
World make_office() {
    std::vector<Box> solids;
    add_shell(solids, kOfficeHalfWidth, kOfficeHalfHeight);
    add_outer_rooms(solids);
    add_inner_rooms(solids);
    add_furniture(solids);
    return make_world("office", std::move(solids),
                      {
                          {-kOfficeHalfWidth, -kCorridorOuter, kOfficeHalfWidth, -kCorridorInner},
                          {-kOfficeHalfWidth, kCorridorInner, kOfficeHalfWidth, kCorridorOuter},
                          {-kOfficeHalfWidth, -kCorridorOuter, -kBlockHalfWidth, kCorridorOuter},
                          {kBlockHalfWidth, -kCorridorOuter, kOfficeHalfWidth, kCorridorOuter},
                      });
}

} // namespace scanloom::robot
