#pragma once

#include "robot_client/sim/random.hpp"
#include "robot_client/sim/world.hpp"

#include <cstdint>
#include <vector>

/// What a robot sees that stands still, in worlds in which a door moves: what alignments and the like are tried on.
namespace scanloom::robot {

/// The points of some turns of "lidar360", noise included, in the robot's frame.
[[nodiscard]] std::vector<Point2> standing_capture(const World& world, const Pose2& place, int turns, Random& random);

/// Where doors may stand: shut in the office's doorways and at the hall's cabin, ajar along the room's walls.
[[nodiscard]] std::vector<Box> doors_of(const World& world);

/// The world with one more solid.
[[nodiscard]] World with_door(const World& world, const Box& door);

/// A place where a robot may be put, 0.3 m from anything at least, looking anywhere.
[[nodiscard]] Pose2 free_place(const World& world, Random& random);

/// Whether nothing stands between two places, nor just behind the second.
[[nodiscard]] bool sees(const World& world, const Pose2& from, const Pose2& to);

inline constexpr int kAlignedTurns = 20; ///< of the lidar, in each of two places

/// A robot was in two places of a world between which a door moved.
struct TwoCaptures {
    std::vector<Point2> first; ///< each in the frame of its robot
    std::vector<Point2> second;
    Pose2 T_first_second;
};

/// Two places 0.5 to 2 m apart in any directions, each in sight of the other, with the door open in one of them.
/// @param doors  one of them moves; none: nothing does
[[nodiscard]] TwoCaptures two_captures(const World& open, const std::vector<Box>& doors, std::uint64_t seed,
                                       int turns = kAlignedTurns);

} // namespace scanloom::robot
