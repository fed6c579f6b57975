#pragma once

#include "sim/world.hpp"

#include <array>

namespace scanloom::lab {

enum class Door { kClosed, kOpen };

/// Returns the simulator's room with a doorway, 1 m wide, in its eastern wall, and a lobby of 2 x 3 m behind it. The
/// door is a leaf, 4 cm thick, hinged at the northern end of the doorway. Closed, it fills the doorway; open, it stands
/// at a right angle to it, inside the room. Nothing else differs.
[[nodiscard]] sim::World make_door_room(Door door);

/// Lidar poses in the room, T_map_lidar. The door is visible from all of them, and the second place is visible from the
/// other two.
inline constexpr std::array<Pose2, 3> kDoorRoomPlaces{Pose2{1.3, 2.9, 0.4}, Pose2{3.4, 2.2, -1.9},
                                                      Pose2{3.5, -0.6, 2.6}};

} // namespace scanloom::lab
