#include "sim/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace scanloom::sim {
namespace {

double length_of(const std::vector<Point2>& loop) {
    double length = 0.0;
    for (std::size_t i = 0; i < loop.size(); ++i) length += norm(loop[(i + 1) % loop.size()] - loop[i]);
    return length;
}

} // namespace

Disc body_of(const Walker& walker) {
    const auto& loop = walker.loop;
    const double length = length_of(loop);
    assert(length > 0.0);
    double left = std::fmod(walker.walked, length);
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const Point2 side = loop[(i + 1) % loop.size()] - loop[i];
        if (left < norm(side)) return {loop[i] + left / norm(side) * side, walker.radius};
        left -= norm(side);
    }
    return {loop.front(), walker.radius}; // due to rounding: a whole loop
}

void walk(Walker& walker, const Point2& robot, double seconds) {
    const auto distance_to_robot = [&](const Walker& at) { return norm(body_of(at).centre - robot); };
    Walker next = walker;
    next.walked += walker.pace * seconds;
    const bool comes_nearer = distance_to_robot(next) < distance_to_robot(walker);
    if (comes_nearer && distance_to_robot(next) < kWalkerDistance) return;
    walker = std::move(next);
}

World make_world(std::string name, std::vector<Box> solids, std::vector<Box> floors) {
    World world;
    world.name = std::move(name);
    world.solids = std::move(solids);
    world.starts = floors;
    world.floors = std::move(floors);
    for (const Box& box : world.solids) {
        world.outlines.push_back({box.x_min, box.y_min, box.x_max, box.y_min});
        world.outlines.push_back({box.x_max, box.y_min, box.x_max, box.y_max});
        world.outlines.push_back({box.x_max, box.y_max, box.x_min, box.y_max});
        world.outlines.push_back({box.x_min, box.y_max, box.x_min, box.y_min});
    }
    world.obstacles = std::make_shared<const Obstacles>(world.outlines, world.solids);
    return world;
}

Box bounds_of(const World& world) {
    Box all = world.solids.empty() ? world.floors.front() : world.solids.front();
    for (const Box& box : world.solids) all = united(all, box);
    for (const Box& box : world.floors) all = united(all, box);
    return all;
}

double clearance(const World& world, const Point2& point) {
    if (world.obstacles->contain(point)) return 0.0;
    double nearest = world.obstacles->distance(point);
    for (const Walker& walker : world.walkers) nearest = std::min(nearest, distance(body_of(walker), point));
    return nearest;
}

std::vector<Disc> people_near(const World& world, const Point2& place, double radius) {
    std::vector<Disc> people;
    for (const Walker& walker : world.walkers) {
        if (distance(body_of(walker), place) <= radius) people.push_back(body_of(walker));
    }
    return people;
}

void walk(World& world, const Point2& robot, double seconds) {
    for (Walker& walker : world.walkers) walk(walker, robot, seconds);
}

Result<World> find_world(std::string_view name) {
    std::string names;
    for (const NamedWorld& world : kWorlds) {
        if (world.name == name) return world.make();
        names += names.empty() ? "" : world.name == kWorlds.back().name ? " or " : ", ";
        names += world.name;
    }
    return Error{Errc::kNotFound, fmt::format("unknown world '{}'; choose {}", name, names)};
}

} // namespace scanloom::sim
