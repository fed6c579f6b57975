#include "sim/tour.hpp"

namespace scanloom::robot {
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

} // namespace scanloom::robot
