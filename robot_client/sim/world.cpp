#include "robot_client/sim/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace scanloom::robot {

World make_world(std::string name, std::vector<Box> solids, std::vector<Box> floors) {
    World world{std::move(name), std::move(solids), std::move(floors), {}, {}};
    for (const Box& box : world.solids) {
        world.outlines.push_back({box.x_min, box.y_min, box.x_max, box.y_min});
        world.outlines.push_back({box.x_max, box.y_min, box.x_max, box.y_max});
        world.outlines.push_back({box.x_max, box.y_max, box.x_min, box.y_max});
        world.outlines.push_back({box.x_min, box.y_max, box.x_min, box.y_min});
    }
    return world;
}

double distance(const Segment& segment, const Point2& point) {
    const double along_x = segment.bx - segment.ax;
    const double along_y = segment.by - segment.ay;
    const double to_x = point.x() - segment.ax;
    const double to_y = point.y() - segment.ay;
    const double share =
        std::clamp((to_x * along_x + to_y * along_y) / (along_x * along_x + along_y * along_y), 0.0, 1.0);
    return std::hypot(to_x - share * along_x, to_y - share * along_y);
}

double clearance(const World& world, const Point2& point) {
    for (const Box& box : world.solids) {
        if (box.contains(point)) return 0.0;
    }
    double nearest = std::numeric_limits<double>::infinity();
    for (const Segment& segment : world.outlines) nearest = std::min(nearest, distance(segment, point));
    for (const Walker& walker : world.walkers) nearest = std::min(nearest, distance(body_of(walker), point));
    return nearest;
}

void walk(World& world, const Point2& robot, double seconds) {
    for (Walker& walker : world.walkers) walk(walker, robot, seconds);
}

Result<World> find_world(std::string_view name) {
    if (name == "room") return make_room();
    if (name == "room_walker") return make_room_walker();
    if (name == "office") return make_office();
    return Error{Errc::kNotFound, fmt::format("there is no world '{}'; choose room, room_walker or office", name)};
}

} // namespace scanloom::robot
