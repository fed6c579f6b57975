#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"
#include "server/http/handlers/call.hpp"
#include "server/http/handlers/maps_lookup.hpp"
#include "server/planning/goals.hpp"
#include "server/planning/passability.hpp"

#include <boost/json/object.hpp>
#include <boost/json/value.hpp>

#include <initializer_list>
#include <optional>
#include <string_view>
#include <vector>

/// What requests for ways have in common. All errors name the field.
namespace scanloom::http {

/// Where a path begins.
struct Place {
    Point2 point;                           ///< metres, map frame
    std::optional<double> body_radius = {}; ///< metres, of the robot that is there, where one was named that states it
};

/// MapsLookup::find() for a search: none is begun while the server shuts down.
/// Errors  also kShuttingDown.
[[nodiscard]] Result<Maps> find_for_search(const MapsLookup& maps, const Call& call,
                                           std::initializer_list<std::string_view> known);

/// The parameters or members size_min and body_radius; without the latter the body is `own`, if that is known.
/// Errors  kInvalidField.
[[nodiscard]] Result<planning::ExplorationOptions> exploration_options(const Query& query,
                                                                       const std::optional<double>& own = {});

[[nodiscard]] Result<planning::ExplorationOptions> exploration_options(const boost::json::object& body,
                                                                       const std::optional<double>& own = {});

/// The members allow_unknown, body_radius and danger_cost, each if it is there; `own` as above. Ranges are for the
/// planning to check.
/// Errors  kInvalidField.
[[nodiscard]] Result<planning::PassabilityOptions> passability_options(const boost::json::object& body,
                                                                       const std::optional<double>& own);

/// [x, y], in metres.
/// Errors  kInvalidField: something else, or further out than any robot may be.
[[nodiscard]] Result<Point2> read_point(const boost::json::value& value, std::string_view name);

/// [x, y], or {"robot": name}: where that robot is.
/// Errors  kInvalidField; kNotFound: no such robot; kNoPath: nobody knows where it is.
[[nodiscard]] Result<Place> read_place(const boost::json::value& value, std::string_view name,
                                       const mapping::Snapshot& maps);

/// A polygon's corners [[x, y], ...], or a box [min_x, min_y, max_x, max_y].
/// Errors  kInvalidField.
[[nodiscard]] Result<std::vector<Point2>> read_region(const boost::json::value& value, std::string_view name);

} // namespace scanloom::http
