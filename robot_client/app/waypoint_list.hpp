#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"

#include <string>
#include <vector>

namespace scanloom::robot {

/// Waypoints as people write them: "x,y;x,y;...", metres, or the path of a file with one on each line: "x y" or "x,y";
/// there empty lines and what follows a # do not count.
/// Errors  kNotFound: a file that cannot be read; kInvalidField: what is no waypoint, with its place in the list or the
///         line of the file; none at all, or more than 10,000.
[[nodiscard]] Result<std::vector<Point2>> read_waypoints(const std::string& list);

/// "x,y;x,y;...", different for different waypoints.
[[nodiscard]] std::string to_text(const std::vector<Point2>& waypoints);

} // namespace scanloom::robot
