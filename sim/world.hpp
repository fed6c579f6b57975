#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"
#include "sim/obstacles.hpp"
#include "sim/shapes.hpp"

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::sim {

/// A person as a laser sees one: a disc that moves around a closed loop at constant speed.
struct Walker {
    std::vector<Point2> loop; ///< corners, metres; the last one connects to the first
    double radius = 0.25;     ///< metres
    double pace = 1.0;        ///< metres per second
    double walked = 0.0;      ///< metres since the first corner
};

/// Returns the walker's current disc. Pre: its loop has a length greater than 0.
[[nodiscard]] Disc body_of(const Walker& walker);

/// A walker does not come nearer than this to a robot's centre by itself; it waits until the robot has left.
inline constexpr double kWalkerDistance = 0.7; // metres

/// Moves the walker for some time, or lets it wait if it would come too near to the robot.
void walk(Walker& walker, const Point2& robot, double seconds);

inline constexpr double kStartClearance = 0.5; ///< metres, if there is room

/// The environment of a simulated robot at one time. Built-in worlds are closed: from any point of a floor every ray
/// hits a solid. Worlds from maps may be open.
struct World {
    std::string name;
    std::vector<Box> solids;  ///< walls and furniture; overlapping ones leave no gap
    std::vector<Box> floors;  ///< free except for solids on them; everything reachable from them is free, too
    std::vector<Box> unknown; ///< unknown areas of a map: neither solid nor free
    std::vector<Box> starts;  ///< where a robot may start, except where solids are
    double start_clearance = kStartClearance; ///< metres that are free around a robot's start
    std::vector<Segment> outlines;            ///< sides of the solids
    std::vector<Walker> walkers;              ///< people at their current positions
    std::shared_ptr<const Obstacles> obstacles = std::make_shared<const Obstacles>(); ///< index of outlines and solids
};

/// Makes a world of boxes and their outlines. Robots may start on any floor.
[[nodiscard]] World make_world(std::string name, std::vector<Box> solids, std::vector<Box> floors);

/// Returns the smallest box that contains all solids and floors. Pre: there is at least one.
[[nodiscard]] Box bounds_of(const World& world);

/// Returns the distance in metres from a point to the nearest outline or walker; 0 inside one.
[[nodiscard]] double clearance(const World& world, const Point2& point);

/// Returns the discs of the people within `radius` metres of a place.
[[nodiscard]] std::vector<Disc> people_near(const World& world, const Point2& place, double radius);

/// Moves the walkers for some time, around a robot.
void walk(World& world, const Point2& robot, double seconds);

/// "room": 10 x 10 m with furniture. "room_walker": the same with a person who walks around the free-standing
/// furniture. "office": 30 x 20 m, thirteen rooms and two lounges around a ring of corridors. "hall": 60 x 40 m,
/// pillars, racks, loading bays and loose objects: long lines of sight.
[[nodiscard]] World make_room();
[[nodiscard]] World make_room_walker();
[[nodiscard]] World make_office();
[[nodiscard]] World make_hall();

struct NamedWorld {
    std::string_view name;
    World (*make)();
};
inline constexpr std::array kWorlds{NamedWorld{"room", make_room}, NamedWorld{"room_walker", make_room_walker},
                                    NamedWorld{"office", make_office}, NamedWorld{"hall", make_hall}};

/// Returns a built-in world by name.
/// Errors: kNotFound if there is no world of that name; the message lists all names.
[[nodiscard]] Result<World> find_world(std::string_view name);

/// Returns a round tour of a world of find_world(): waypoints, each in sight of the one before, in metres in the world
/// frame. Empty if the world has no tour.
[[nodiscard]] std::vector<Point2> tour_of(std::string_view world);

} // namespace scanloom::sim
