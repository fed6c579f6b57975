#pragma once

#include "sim/drive/behaviour.hpp"
#include "sim/drive/ground.hpp"
#include "sim/drive/path_follower.hpp"

#include <deque>
#include <optional>
#include <vector>

namespace scanloom::sim {

/// A straight segment of a sweep, parallel to the x axis; metres in the map frame.
struct Lane {
    Point2 west{0.0, 0.0};
    Point2 east{0.0, 0.0};
};

/// Lanes one above the other, from the south, that are swept back and forth without choosing an order.
using Block = std::vector<Lane>;

/// Divides cells into blocks and each block into evenly spaced lanes at most `spacing_m` apart. There is one lane along
/// the lowest row and one along the highest, but none if that whole row borders another block, whose lane there is near
/// enough. For the blocks see planning::sweep_blocks().
/// @param cells  the cells of the area
[[nodiscard]] std::vector<Block> lanes_over(const Ground& ground, const BitGrid& cells, double spacing_m);

/// Sweeps the free cells of a known map back and forth, lane by lane and block by block, the nearest block next. An
/// obstacle in a lane that is not in the map stops the robot. It waits two seconds for the obstacle to leave, then
/// makes a detour to the first place of the lane beyond what it sees of the obstacle, and plans again whenever it sees
/// more. It gives up the rest of the lane if there is no path. On the path to a lane it takes another path instead.
class Zigzag final : public Behaviour {
public:
    /// Distance in metres that lanes keep from obstacles of the plan.
    static constexpr double kLaneClearance = kBodyRadius + 0.10;

    explicit Zigzag(const FloorPlan& plan);

    [[nodiscard]] Velocity step(const Senses& senses) override;
    [[nodiscard]] bool is_done() const override { return task_ == Task::kDone; }
    [[nodiscard]] bool has_an_end() const override { return true; }
    [[nodiscard]] std::string remarks() const override;

    [[nodiscard]] double coverage() const noexcept { return meter_.share(); } ///< 0 .. 1, of what the robot can reach

private:
    enum class Task { kBegin, kGo, kSweep, kDetour, kDone };

    void begin(const Point2& position);
    void choose_block(const Point2& position);
    void begin_next_lane(const Point2& position);
    [[nodiscard]] Velocity go(const Senses& senses);
    [[nodiscard]] Velocity sweep(const Senses& senses);
    [[nodiscard]] Velocity go_around(const Senses& senses);
    [[nodiscard]] bool plan_detour(const Senses& senses);
    void sweep_on();
    void give_up_lane(const Point2& position);

    Ground ground_;
    CoverageMeter meter_;
    std::vector<Block> blocks_; // not begun
    std::deque<Lane> lanes_;    // lanes of the current block that are not begun
    Point2 lane_begin_{0.0, 0.0};
    Point2 lane_end_{0.0, 0.0};
    Task task_ = Task::kBegin;
    PathFollower follower_;
    Point2 blocked_at_{0.0, 0.0};   // where this detour began
    std::optional<Ground> around_;  // the ground without the obstacles seen during this detour
    int lane_detours_ = 0;          // begun in this lane
    int other_paths_ = 0;           // paths tried to reach this lane
    std::vector<Point2> obstacles_; // obstacles seen there that are not in the plan
    int lanes_swept_ = 0;
    int detours_ = 0; // that returned to their lane
    int given_up_ = 0;
};

} // namespace scanloom::sim
