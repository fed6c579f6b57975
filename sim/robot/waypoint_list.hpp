#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"

#include <string>
#include <vector>

namespace scanloom::sim {

/// Reads waypoints from "x,y;x,y;..." in metres, or from a file given by its path with one "x y" or "x,y" per line. In
/// a file, empty lines and text after # are ignored.
/// Errors: kNotFound if a file cannot be read; kInvalidField if an entry is not a waypoint (with its position in the
///         list or its line), or if there are none or more than 10,000.
[[nodiscard]] Result<std::vector<Point2>> read_waypoints(const std::string& list);

/// Returns "x,y;x,y;..."; different waypoints give different texts.
[[nodiscard]] std::string to_text(const std::vector<Point2>& waypoints);

} // namespace scanloom::sim
