#include "sim/world.hpp"

#include <algorithm>
#include <array>

namespace scanloom::sim {

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

namespace {

/// Appends the four outer walls of a building that is centred on the origin.
/// @param half_width, half_height  half its inner extent along x and y, metres
void add_shell(std::vector<Box>& solids, double half_width, double half_height) {
    constexpr double kThick = 0.3;
    const double outer_x = half_width + kThick;
    const double outer_y = half_height + kThick;
    solids.push_back({-outer_x, -outer_y, outer_x, -half_height});
    solids.push_back({-outer_x, half_height, outer_x, outer_y});
    solids.push_back({-outer_x, -outer_y, -half_width, outer_y});
    solids.push_back({half_width, -outer_y, outer_x, outer_y});
}

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

namespace {

/// Along the walls, and once between the furniture.
std::vector<Point2> room_tour() {
    return {{-3.5, -3.7}, {0.4, -3.7}, {0.5, -1.7}, {0.9, -3.5}, {3.5, -3.6}, {3.4, -0.3},
            {3.5, 3.4},   {1.2, 3.5},  {-3.2, 3.7}, {-3.4, 1.2}, {-3.4, -0.6}};
}

/// Adds a visit to a room: before its door, inside, before its door again.
void visit(std::vector<Point2>& tour, const Point2& before, const Point2& inside) {
    tour.insert(tour.end(), {before, inside, before});
}

/// The southern corridor eastwards, the northern one westwards, and every room.
std::vector<Point2> office_tour() {
    std::vector<Point2> tour;
    tour.push_back({-13.4, -3.0});
    for (const double door : {-10.4, -4.4, 1.6, 7.6, 13.6}) visit(tour, {door, -3.0}, {door - 0.6, -6.5});
    tour.push_back({13.8, 0.0});
    for (const double door : {10.4, 4.4, -1.6, -7.6, -13.6}) {
        visit(tour, {door, 3.0}, {door + 0.8, 6.5});
        if (door == 10.4) visit(tour, {7.0, 3.0}, {7.0, 1.3});   // a meeting room
        if (door == 4.4) visit(tour, {0.0, 3.0}, {0.0, 0.0});    // the kitchen
        if (door == -1.6) visit(tour, {-7.0, 3.0}, {-7.0, 1.3}); // the other meeting room
    }
    tour.push_back({-13.8, 0.0});
    return tour;
}

/// Up and down the aisles in the north, past the cabin and the loading bays, across the floor, and through the aisles
/// in the south.
std::vector<Point2> hall_tour() {
    std::vector<Point2> tour = {{-28.5, 3.5},  {-28.5, 18.5}, {-24.6, 18.5}, {-24.6, 3.5},  {-21.0, 3.5}, {-21.0, 18.5},
                                {-17.4, 18.5}, {-17.4, 3.5},  {-13.8, 3.5},  {-13.8, 18.5}, {-8.0, 18.0}, {-8.0, 12.5}};
    visit(tour, {1.0, 13.3}, {1.0, 16.8});
    tour.insert(tour.end(), {{12.0, 17.0}, {21.5, 18.0}});
    visit(tour, {21.5, 12.0}, {27.0, 12.0});
    tour.push_back({21.5, 6.0});
    visit(tour, {21.5, 0.0}, {26.5, 0.0});
    visit(tour, {21.5, -6.0}, {27.0, -6.0});
    visit(tour, {21.5, -17.5}, {27.0, -17.5});
    tour.insert(tour.end(), {{12.0, -14.5},
                             {6.0, -13.5},
                             {6.0, -4.0},
                             {6.0, 1.5},
                             {-2.0, 4.0},
                             {-2.0, -5.0},
                             {-3.0, -14.0},
                             {-8.5, -18.0},
                             {-8.5, -8.0},
                             {-13.5, -6.5},
                             {-17.4, -3.5},
                             {-17.4, -18.5},
                             {-21.0, -18.5},
                             {-21.0, -3.5},
                             {-24.6, -3.5},
                             {-24.6, -18.5},
                             {-28.5, -18.5},
                             {-28.5, -3.5},
                             {-27.5, 0.0}});
    return tour;
}

} // namespace

std::vector<Point2> tour_of(std::string_view world) {
    if (world == "room" || world == "room_walker") return room_tour();
    if (world == "office") return office_tour();
    if (world == "hall") return hall_tour();
    return {};
}

} // namespace scanloom::sim
