#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"
#include "server/mapping/snapshot.hpp"

#include <string_view>

namespace scanloom::guide {

/// Errors  kNotFound: no robot of that name ever joined the session.
[[nodiscard]] Result<RobotIndex> find_robot(const mapping::Snapshot& maps, std::string_view name);

/// T_map_robot of the robot's newest scan that is in the maps.
/// Errors  kNoPath: it has sent none, or joined after their last entry; so there is no way from there.
[[nodiscard]] Result<Pose2> pose_of(const mapping::Snapshot& maps, RobotIndex robot);

} // namespace scanloom::guide
