#include "robot_client/sim/walker.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace scanloom::robot {
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

} // namespace scanloom::robot
