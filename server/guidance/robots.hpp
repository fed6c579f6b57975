#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"
#include "core/mapping/snapshot.hpp"

#include <string_view>

namespace scanloom::guidance {

/// Returns the index of the robot with the given name.
/// Errors: kNotFound if no robot of that name ever joined the session.
[[nodiscard]] Result<RobotIndex> find_robot(const mapping::Snapshot& maps, std::string_view name);

/// Returns T_map_robot of the robot's newest scan in the maps.
/// Errors: kNoPath if the robot has sent no scan, is lost, or joined after the maps' last entry: no path can start there.
[[nodiscard]] Result<Pose2> pose_of(const mapping::Snapshot& maps, RobotIndex robot);

} // namespace scanloom::guidance
