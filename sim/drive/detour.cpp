#include "sim/drive/detour.hpp"

#include "sim/drive/behaviour.hpp"
#include "sim/drive/nearby_obstacles.hpp"
#include "sim/drive/path_follower.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

namespace scanloom::robot {
namespace {

// metres
constexpr double kExpected = 0.12;               // from what the plan knows
constexpr double kPassing = kBodyRadius + 0.12;  // from an obstacle that is passed
constexpr double kNoGapBetween = 2.0 * kPassing; // obstacles nearer to each other than this count as one
constexpr double kOffsetMax = 1.6;
constexpr double kSeenAhead = 1.5; // obstacles within this distance ahead decide where to pass
constexpr double kPastMin = 0.6;   // room ahead, parallel to the line
// control steps
constexpr int kSeenSteps = 200;
constexpr int kDetourBlockedStepsMax = 40;

bool any_within(const std::vector<Point2>& places, double x_min, double x_max, double y_min, double y_max) {
    return std::ranges::any_of(places, [&](const Point2& place) {
        return place.x > x_min && place.x < x_max && place.y > y_min && place.y < y_max;
    });
}

} // namespace

std::vector<Point2> unexpected_obstacles(const Ground& ground, const Senses& senses) {
    std::vector<Point2> unexpected;
    std::ranges::copy_if(senses.obstacles, std::back_inserter(unexpected),
                         [&](const Point2& obstacle) { return !ground.is_near_solid(obstacle, kExpected); });
    return unexpected;
}

Point2 Detour::Line::to_line(const Point2& point) const {
    const Point2 offset = point - begin;
    return {dot(offset, ahead), ahead.x * offset.y - ahead.y * offset.x};
}

Point2 Detour::Line::to_map(const Point2& point) const {
    return begin + point.x * ahead + point.y * Point2{-ahead.y, ahead.x};
}

std::optional<Detour> Detour::plan(const Ground& ground, const Senses& senses, const Point2& end) {
    const Point2 begin = position_of(senses.pose);
    const double length = norm(end - begin);
    if (length <= 0.0) return std::nullopt;
    const Line line{begin, (end - begin) / length, length};
    std::vector<Point2> obstacles;
    double first = kSeenAhead;
    for (const Point2& obstacle : unexpected_obstacles(ground, senses)) {
        const Point2 place = line.to_line(obstacle);
        if (place.x <= 0.0 || place.x >= kSeenAhead) continue;
        obstacles.push_back(place);
        if (std::abs(place.y) < kKeptClear) first = std::min(first, place.x);
    }
    const auto offset = side(ground, line, obstacles, first);
    if (!offset) return std::nullopt;
    return Detour(line, *offset, first);
}

/// Returns how far to the left of the line to pass, or nullopt if there is no room or no obstacle.
std::optional<double> Detour::side(const Ground& ground, const Line& line, const std::vector<Point2>& obstacles,
                                   double first) {
    if (first >= kSeenAhead) return std::nullopt;
    double right = 0.0; // the obstacles to pass as one, from here
    double left = 0.0;  // to there
    for (bool grows = true; grows;) {
        grows = false;
        for (const Point2& place : obstacles) {
            const bool belongs = place.y > right - kNoGapBetween && place.y < left + kNoGapBetween;
            if (!belongs || (place.y >= right && place.y <= left)) continue;
            right = std::min(right, place.y);
            left = std::max(left, place.y);
            grows = true;
        }
    }
    const auto has_room = [&](double offset) {
        const auto [low, high] = std::minmax({0.0, offset});
        const double past = std::min(kPastMin, line.length);
        return std::abs(offset) <= kOffsetMax && ground.fits_along(line.to_map({0, 0}), line.to_map({0, offset})) &&
               ground.fits_along(line.to_map({0, offset}), line.to_map({past, offset})) &&
               !any_within(obstacles, 0.0, kKeptClear, low - kKeptClear, high + kKeptClear) &&
               !any_within(obstacles, 0.0, past, offset - kKeptClear, offset + kKeptClear);
    };
    std::array<double, 2> offsets{left + kPassing, right - kPassing};
    if (std::abs(offsets[1]) < std::abs(offsets[0])) std::swap(offsets[0], offsets[1]);
    for (const double offset : offsets) {
        if (has_room(offset)) return offset;
    }
    return std::nullopt;
}

Detour::Detour(const Line& line, double offset, double first_obstacle)
    : line_(line), offset_(offset), first_obstacle_(first_obstacle),
      follower_({line.begin, line.to_map({0.0, offset})}) {}

Velocity Detour::step(const Ground& ground, const Senses& senses) {
    if (state_ != State::kActive) return {};
    step_ += 1;
    remember(ground, senses);
    const Point2 position = position_of(senses.pose);
    const bool turns_back = part_ == Part::kPast && may_return(ground, line_.to_line(position));
    if (turns_back || follower_.has_arrived()) begin_next_part(ground, position);
    if (state_ != State::kActive) return {};
    const Velocity velocity = follower_.step(senses);
    if (follower_.blocked_steps() > kDetourBlockedStepsMax) state_ = State::kFailed;
    return velocity;
}

void Detour::begin_next_part(const Ground& ground, const Point2& position) {
    const Point2 place = line_.to_line(position);
    if (part_ == Part::kAside) {
        part_ = Part::kPast;
        room_ = free_length(ground);
        follower_ = PathFollower({line_.to_map({0.0, offset_}), line_.to_map({room_, offset_})});
    } else if (part_ == Part::kBack) {
        state_ = State::kBackOnLine;
    } else if (may_return(ground, place)) {
        part_ = Part::kBack;
        follower_ = PathFollower({position, line_.to_map({place.x, 0.0})});
    } else {
        state_ = room_ < line_.length ? State::kFailed : State::kPastEnd;
    }
}

/// Returns how far the ground is free parallel to the line, in metres, up to the line's end.
double Detour::free_length(const Ground& ground) const {
    const double step = ground.cell_size();
    double room = 0.0;
    while (room < line_.length) {
        const double next = std::min(room + step, line_.length);
        if (!ground.fits_along(line_.to_map({room, offset_}), line_.to_map({next, offset_}))) break;
        room = next;
    }
    return room;
}

void Detour::remember(const Ground& ground, const Senses& senses) {
    std::erase_if(seen_, [&](const Seen& seen) { return seen.step < step_ - kSeenSteps; });
    if (step_ % 2 == 0) return; // a scan arrives every other step
    const auto [low, high] = std::minmax({0.0, offset_});
    for (const Point2& obstacle : unexpected_obstacles(ground, senses)) {
        const Point2 place = line_.to_line(obstacle);
        if (place.y > low - kPassing && place.y < high + kPassing) seen_.push_back({place, step_});
    }
}

/// Returns whether the robot can go straight back to the line.
bool Detour::may_return(const Ground& ground, const Point2& on_line) const {
    if (on_line.x < first_obstacle_ + kPassing) return false;
    const auto blocks = [&](const Seen& seen) { return std::abs(seen.place.x - on_line.x) < kPassing; };
    return std::ranges::none_of(seen_, blocks) &&
           ground.fits_along(line_.to_map(on_line), line_.to_map({on_line.x, 0.0}));
}

} // namespace scanloom::robot
