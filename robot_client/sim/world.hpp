#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"
#include "robot_client/sim/obstacles.hpp"
#include "robot_client/sim/walker.hpp"

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::robot {

inline constexpr double kStartClearance = 0.5; ///< metres, where there is room

/// A place to drive in, at one moment. Those that have a name here are closed: from any point of a floor every ray
/// meets a solid. Maps of elsewhere may be open.
struct World {
    std::string name;
    std::vector<Box> solids;  ///< walls and furniture; they may overlap and then leave no gap between them
    std::vector<Box> floors;  ///< free but for solids that stand on them, and whatever can be reached from there
    std::vector<Box> unknown; ///< what a map does not tell of: neither solid nor free
    std::vector<Box> starts;  ///< where a robot may be put, but for what stands there
    double start_clearance = kStartClearance; ///< metres that are free around a robot which is put there
    std::vector<Segment> outlines;            ///< the sides of the solids
    std::vector<Walker> walkers;              ///< people, where they are now
    std::shared_ptr<const Obstacles> obstacles = std::make_shared<const Obstacles>(); ///< outlines and solids, in order
};

/// A world of boxes: builds their outlines. Robots may be put on any floor.
[[nodiscard]] World make_world(std::string name, std::vector<Box> solids, std::vector<Box> floors);

/// The least box that holds all solids and floors. Pre  there are some.
[[nodiscard]] Box bounds_of(const World& world);

/// Metres from a point to the nearest outline or walker; 0 inside one.
[[nodiscard]] double clearance(const World& world, const Point2& point);

/// The bodies of people within `radius` metres of a place.
[[nodiscard]] std::vector<Disc> people_near(const World& world, const Point2& place, double radius);

/// Lets the walkers go on for some time, around a robot.
void walk(World& world, const Point2& robot, double seconds);

/// "room": 10 x 10 m with furniture. "room_walker": the same, and a person who walks around what stands free in it.
/// "office": 30 x 20 m, thirteen rooms and two lounges around a ring of corridors.
/// "hall": 60 x 40 m, pillars, racks, loading bays and what stands about: long lines of sight.
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

/// Errors  kNotFound: no world of that name; the message lists those there are.
[[nodiscard]] Result<World> find_world(std::string_view name);

} // namespace scanloom::robot
