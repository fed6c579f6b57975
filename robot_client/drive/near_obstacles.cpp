#include "robot_client/drive/near_obstacles.hpp"

#include <cmath>

namespace scanloom::robot {
namespace {

constexpr double kNear = 1.0;    // metres
constexpr double kSquare = 0.05; // metres
constexpr int kRememberedSteps = 60;

} // namespace

void NearObstacles::see(const Senses& senses) {
    const Point2 position{senses.pose.x, senses.pose.y};
    step_ += 1;
    for (const Point2& place : senses.obstacles) {
        if (norm(place - position) > kNear) continue;
        const std::pair square{std::llround(place.x / kSquare), std::llround(place.y / kSquare)};
        seen_.insert_or_assign(square, Seen{place, step_});
    }
    std::erase_if(seen_, [&](const auto& one) {
        const Seen& seen = one.second;
        return seen.step <= step_ - kRememberedSteps || norm(seen.place - position) > kNear;
    });
}

std::vector<Point2> NearObstacles::places() const {
    std::vector<Point2> places;
    places.reserve(seen_.size());
    for (const auto& [square, seen] : seen_) places.push_back(seen.place);
    return places;
}

} // namespace scanloom::robot
