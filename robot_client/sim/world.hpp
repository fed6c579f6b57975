#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"
#include "robot_client/sim/walker.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace scanloom::robot {

/// A straight piece of something that lasers see and robots bump into. Metres, in the world frame.
struct Segment {
    double ax = 0.0;
    double ay = 0.0;
    double bx = 0.0;
    double by = 0.0;
};

/// A rectangle along the axes. Metres, in the world frame.
struct Box {
    double x_min = 0.0;
    double y_min = 0.0;
    double x_max = 0.0;
    double y_max = 0.0;

    [[nodiscard]] bool contains(const Point2& point) const noexcept {
        return point.x() >= x_min && point.x() <= x_max && point.y() >= y_min && point.y() <= y_max;
    }
};

/// A place to drive in, at one moment. It is closed: from any point of a floor every ray meets a solid.
struct World {
    std::string name;
    std::vector<Box> solids;       ///< walls and furniture; they may overlap and then leave no gap between them
    std::vector<Box> floors;       ///< where a robot may be put, furniture included
    std::vector<Segment> outlines; ///< the sides of the solids
    std::vector<Walker> walkers;   ///< people, where they are now
};

/// Builds the outlines of the solids.
[[nodiscard]] World make_world(std::string name, std::vector<Box> solids, std::vector<Box> floors);

/// Metres from a point to the nearest outline or walker; 0 inside one.
[[nodiscard]] double clearance(const World& world, const Point2& point);

[[nodiscard]] double distance(const Segment& segment, const Point2& point);

/// Lets the walkers go on for some time, around a robot.
void walk(World& world, const Point2& robot, double seconds);

/// "room": 10 x 10 m with furniture. "room_walker": the same, and a person who walks around what stands free in it.
/// "office": 30 x 20 m, thirteen rooms and two lounges around a ring of corridors.
[[nodiscard]] World make_room();
[[nodiscard]] World make_room_walker();
[[nodiscard]] World make_office();

/// Errors  kNotFound: no world of that name; the message lists those there are.
[[nodiscard]] Result<World> find_world(std::string_view name);

} // namespace scanloom::robot
