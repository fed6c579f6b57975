#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"
#include "core/planning/goals.hpp"
#include "server/guidance/plans.hpp"
#include "server/http/context.hpp"
#include "server/http/handlers/lookup.hpp"

#include <boost/json/object.hpp>
#include <boost/json/value.hpp>

#include <optional>
#include <string_view>
#include <vector>

/// Parsing that all requests for planned paths share. Each error names the field.
namespace scanloom::http {

/// Returns find_maps() for a search. No search starts while the server shuts down.
/// Errors: those of find_maps(); kShuttingDown.
[[nodiscard]] Result<Maps> find_for_search(const Context& context);

/// Reads size_min and body_radius from the parameters or members.
/// @param own  the robot's body radius (m), if known; used if body_radius is not given
/// Errors: kInvalidField.
[[nodiscard]] Result<planning::ExplorationOptions> exploration_options(const Query& query);

[[nodiscard]] Result<planning::ExplorationOptions> exploration_options(const boost::json::object& body,
                                                                       const std::optional<double>& own);

/// Reads the optional members allow_unknown, body_radius and danger_cost. The planner checks the ranges.
/// Errors: kInvalidField.
[[nodiscard]] Result<guidance::RequestedBody> requested_body(const boost::json::object& body);

/// Reads [x, y] in metres.
/// Errors: kInvalidField if the value is something else, or further out than any robot may be.
[[nodiscard]] Result<Point2> read_point(const boost::json::value& value, std::string_view name);

/// Reads [x, y], or {"robot": name} for the position of that robot.
/// Errors: kInvalidField; kNotFound if there is no such robot; kNoPath if its position is unknown.
[[nodiscard]] Result<guidance::Start> read_start(const boost::json::value& value, std::string_view name,
                                                 const mapping::Snapshot& maps);

/// Reads the corners of a polygon [[x, y], ...], or a box [min_x, min_y, max_x, max_y].
/// Errors: kInvalidField.
[[nodiscard]] Result<std::vector<Point2>> read_region(const boost::json::value& value, std::string_view name);

} // namespace scanloom::http
