#include "sim/drive/zigzag.hpp"

#include "core/planning/coverage_region.hpp"
#include "sim/drive/ground.hpp"
#include "sim/drive/path_follower.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

namespace scanloom::sim {
namespace {

/// Returns whether each cell of a row has a cell of the area `up` rows above it.
bool borders(const BitGrid& cells, const planning::SweepRow& row, std::int32_t up) {
    return planning::next_clear(cells.row(row.y + up), row.x_begin) >= row.x_end;
}

Block lanes_of(const Ground& ground, const BitGrid& cells, const planning::SweepBlock& rows, std::int32_t spacing) {
    // If another block has a lane along the border, the first lane here is one spacing away from it.
    const bool open_below = borders(cells, rows.front(), -1);
    const bool open_above = borders(cells, rows.back(), 1);
    const std::int32_t first = open_below ? -1 : 0;
    const std::int32_t last = static_cast<std::int32_t>(rows.size()) - (open_above ? 0 : 1);
    const std::int32_t spaces = std::max(1, (last - first + spacing - 1) / spacing);
    Block block;
    for (std::int32_t n = 0; n <= spaces; ++n) {
        if ((n == 0 && open_below) || (n == spaces && (open_above || last == first))) continue;
        const double place = first + static_cast<double>(n) * (last - first) / spaces;
        const auto& row = rows[static_cast<std::size_t>(std::lround(place))];
        block.push_back({ground.centre_of(row.left()), ground.centre_of(row.right())});
    }
    return block;
}

} // namespace

std::vector<Block> lanes_over(const Ground& ground, const BitGrid& cells, double spacing_m) {
    const auto spacing = std::max(1, static_cast<std::int32_t>(spacing_m / ground.cell_size() + 1e-9));
    std::vector<Block> blocks;
    for (const auto& rows : planning::sweep_blocks(cells, 1)) {
        Block block = lanes_of(ground, cells, rows, spacing);
        if (!block.empty()) blocks.push_back(std::move(block));
    }
    return blocks;
}

namespace {

// control steps
constexpr int kBlockedStepsPerDetour = 40;
constexpr int kBlockedStepsPerLane = 200;
constexpr int kDetoursMax = 4;
constexpr int kOtherPathsMax = 3;

/// Lanes overlap by one cell, so small deviations from a lane do not matter.
double spacing_of(double cell_size) { return std::max(2.0 * kBodyRadius - cell_size, cell_size); }

/// Distance in metres that a detour keeps from an obstacle.
constexpr double kPassing = kBodyRadius + 0.07;

/// Returns the points of the newest scan that are not in the plan: more than 0.12 m from everything that stands still
/// there, and not in an obstacle of `known` either. Metres in the map frame.
std::vector<Point2> unexpected_obstacles(const Ground& ground, const Ground& known, const Senses& senses) {
    constexpr double kExpected = 0.12; // metres
    std::vector<Point2> unexpected;
    std::ranges::copy_if(senses.obstacles, std::back_inserter(unexpected), [&](const Point2& obstacle) {
        return !ground.is_near_solid(obstacle, kExpected) &&
               !known.passability().obstacles.test(known.spot_of(obstacle));
    });
    return unexpected;
}

/// Returns true once for every two seconds that the robot is blocked.
bool is_time_for_detour(const PathFollower& follower) {
    return follower.blocked_steps() > 0 && follower.blocked_steps() % kBlockedStepsPerDetour == 0;
}

} // namespace

Zigzag::Zigzag(const FloorPlan& plan) : ground_(plan, kLaneClearance) {}

Velocity Zigzag::step(const Senses& senses) {
    const Point2 position = position_of(senses.pose);
    if (task_ == Task::kBegin) begin(position);
    meter_.pass(ground_, position);
    switch (task_) {
    case Task::kGo: return go(senses);
    case Task::kSweep: return sweep(senses);
    case Task::kDetour: return go_around(senses);
    case Task::kBegin:
    case Task::kDone: break;
    }
    return {};
}

std::string Zigzag::remarks() const {
    std::string text = fmt::format("swept {:.1f} % of the {:.0f} reachable m2, in {} lanes", 100.0 * coverage(),
                                   meter_.reachable_m2(), lanes_swept_);
    if (detours_ > 0) text += fmt::format(", {} detours", detours_);
    if (given_up_ > 0) text += fmt::format(", {} lanes abandoned", given_up_);
    return text;
}

void Zigzag::begin(const Point2& position) {
    const auto places = reachable_from(ground_, position);
    meter_ = CoverageMeter(ground_, places);
    blocks_ = lanes_over(ground_, places, spacing_of(ground_.cell_size()));
    begin_next_lane(position);
}

/// Chooses the block whose first or last lane has the nearest end, and orders its lanes from there.
void Zigzag::choose_block(const Point2& position) {
    std::vector<Point2> entries; // four for each block
    for (const Block& block : blocks_) {
        for (const Lane& lane : {block.front(), block.back()}) {
            entries.push_back(lane.west);
            entries.push_back(lane.east);
        }
    }
    const auto nearest = nearest_by_path(ground_, position, entries);
    if (!nearest) return;
    const auto chosen = blocks_.begin() + static_cast<std::ptrdiff_t>(*nearest / 4);
    lanes_.assign(chosen->begin(), chosen->end());
    if (*nearest % 4 >= 2) std::ranges::reverse(lanes_);
    blocks_.erase(chosen);
}

void Zigzag::begin_next_lane(const Point2& position) {
    for (;;) {
        if (lanes_.empty()) choose_block(position);
        if (lanes_.empty()) break; // all lanes are swept, or none of the rest can be reached
        const Lane lane = lanes_.front();
        lanes_.pop_front();
        const bool from_west = norm(lane.west - position) <= norm(lane.east - position);
        lane_begin_ = from_west ? lane.west : lane.east;
        lane_end_ = from_west ? lane.east : lane.west;
        lane_detours_ = 0;
        other_paths_ = 0;
        obstacles_.clear();
        if (auto path = find_path(ground_, position, lane_begin_)) {
            follower_ = PathFollower(std::move(*path));
            task_ = Task::kGo;
            return;
        }
        given_up_ += 1;
    }
    for (const Block& block : blocks_) given_up_ += static_cast<int>(block.size());
    blocks_.clear();
    task_ = Task::kDone;
}

Velocity Zigzag::go(const Senses& senses) {
    const Point2 position = position_of(senses.pose);
    if (follower_.has_arrived()) {
        sweep_on();
        return sweep(senses);
    }
    const Velocity velocity = follower_.step(senses);
    if (!is_time_for_detour(follower_)) return velocity;
    other_paths_ += 1;
    std::ranges::copy(unexpected_obstacles(ground_, ground_, senses), std::back_inserter(obstacles_));
    const auto around = find_path(ground_.without(obstacles_, kLaneClearance), position, lane_begin_);
    if (other_paths_ > kOtherPathsMax) {
        give_up_lane(position);
    } else if (around) {
        follower_ = PathFollower(*around);
    }
    return {};
}

Velocity Zigzag::sweep(const Senses& senses) {
    const Point2 position = position_of(senses.pose);
    if (follower_.has_arrived()) {
        lanes_swept_ += 1;
        begin_next_lane(position);
        return {};
    }
    const Velocity velocity = follower_.step(senses);
    if (is_time_for_detour(follower_) && lane_detours_ < kDetoursMax) {
        around_ = ground_;
        blocked_at_ = position;
        if (plan_detour(senses)) {
            lane_detours_ += 1;
            task_ = Task::kDetour;
        }
    }
    if (follower_.blocked_steps() > kBlockedStepsPerLane) give_up_lane(position);
    return velocity;
}

Velocity Zigzag::go_around(const Senses& senses) {
    if (follower_.has_arrived()) {
        detours_ += 1;
        sweep_on();
        return {};
    }
    const bool sees_more = !unexpected_obstacles(ground_, *around_, senses).empty();
    const bool is_lost = sees_more && !plan_detour(senses);
    const Velocity velocity = follower_.step(senses);
    if (is_lost || follower_.blocked_steps() > kBlockedStepsPerDetour) sweep_on(); // moving obstacles may have left
    return velocity;
}

/// Plans a path around the obstacles seen during this detour to the first place of the lane beyond them.
/// @return whether there is one
bool Zigzag::plan_detour(const Senses& senses) {
    around_ = around_->without(unexpected_obstacles(ground_, *around_, senses), kPassing);
    const double step = lane_end_.x < blocked_at_.x ? -ground_.cell_size() : ground_.cell_size();
    bool is_blocked = false;
    for (Point2 place{blocked_at_.x, lane_end_.y}; (lane_end_.x - place.x) * step >= 0.0; place.x += step) {
        const bool fits = around_->fits(around_->spot_of(place));
        is_blocked |= !fits;
        if (!is_blocked || !fits) continue;
        if (auto path = find_path(*around_, position_of(senses.pose), place)) {
            follower_ = PathFollower(std::move(*path));
            return true;
        }
    }
    return false;
}

/// Continues along the lane from the robot's position next to it.
void Zigzag::sweep_on() {
    task_ = Task::kSweep;
    follower_ = PathFollower({lane_begin_, lane_end_});
}

void Zigzag::give_up_lane(const Point2& position) {
    given_up_ += 1;
    begin_next_lane(position);
}

} // namespace scanloom::sim
