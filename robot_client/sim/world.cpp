#include "robot_client/sim/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace scanloom::robot {

World make_world(std::string name, std::vector<Box> solids, std::vector<Box> floors) {
    World world{std::move(name), std::move(solids), std::move(floors), {}};
    for (const Box& box : world.solids) {
        const Point2 corners[] = {
            {box.x_min, box.y_min}, {box.x_max, box.y_min}, {box.x_max, box.y_max}, {box.x_min, box.y_max}};
        for (std::size_t i = 0; i < 4; ++i) world.outlines.push_back({corners[i], corners[(i + 1) % 4]});
    }
    return world;
}

double distance(const Segment& segment, const Point2& point) {
    const Point2 along = segment.b - segment.a;
    const double share = std::clamp((point - segment.a).dot(along) / along.squaredNorm(), 0.0, 1.0);
    return (point - segment.a - share * along).norm();
}

double clearance(const World& world, const Point2& point) {
    for (const Box& box : world.solids) {
        if (box.contains(point)) return 0.0;
    }
    double nearest = std::numeric_limits<double>::infinity();
    for (const Segment& segment : world.outlines) nearest = std::min(nearest, distance(segment, point));
    return nearest;
}

Result<World> find_world(std::string_view name) {
    if (name == "room") return make_room();
    if (name == "office") return make_office();
    return Error{Errc::kNotFound, fmt::format("there is no world '{}'; choose room or office", name)};
}

} // namespace scanloom::robot
