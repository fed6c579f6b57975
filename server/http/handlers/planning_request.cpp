#include "server/http/handlers/planning_request.hpp"

#include "common/scan/limits.hpp"
#include "core/planning/coverage_region.hpp"
#include "server/guidance/robots.hpp"
#include "server/http/handlers/parameters.hpp"
#include "server/http/json_read.hpp"
#include "server/http/text.hpp"

#include <boost/json/array.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace scanloom::http {
namespace {

Error invalid(std::string message) { return {Errc::kInvalidField, std::move(message)}; }

Result<double> read_coordinate(const boost::json::value& value, std::string_view name) {
    if (!value.is_number()) return invalid(fmt::format("{} is not a number", name));
    const double metres = value.to_number<double>();
    if (std::abs(metres) <= kCoordinateMax) return metres;
    return invalid(fmt::format("{} is {} m; it must be within {} m of the origin", name, metres, kCoordinateMax));
}

Result<std::vector<Point2>> read_box(const boost::json::array& edges, std::string_view name) {
    std::array<double, 4> box{};
    for (std::size_t n = 0; n < box.size(); ++n) {
        const auto edge = read_coordinate(edges[n], fmt::format("{}[{}]", name, n));
        if (!edge) return edge.error();
        box[n] = *edge;
    }
    const auto [min_x, min_y, max_x, max_y] = box;
    if (min_x < max_x && min_y < max_y) {
        return std::vector<Point2>{{min_x, min_y}, {max_x, min_y}, {max_x, max_y}, {min_x, max_y}};
    }
    return invalid(fmt::format("{} is an empty box; give [min_x, min_y, max_x, max_y]", name));
}

} // namespace

Result<Maps> find_for_search(const Context& context) {
    if (context.services.sessions.is_draining()) return Error{Errc::kShuttingDown, "the server is shutting down"};
    return find_maps(context);
}

Result<planning::ExplorationOptions> exploration_options(const Query& query) {
    planning::ExplorationOptions options;
    const auto size = parameter(query, "size_min", options.frontier_size_min,
                                integer_from<std::size_t>(1, std::numeric_limits<std::size_t>::max()),
                                "a whole number of cells from 1 on is needed");
    if (!size) return size.error();
    options.frontier_size_min = *size;
    const auto radius = parameter(query, "body_radius", std::optional<double>(), parse_real, "metres are needed");
    if (!radius) return radius.error();
    options.passability = guidance::passability_of({.radius = *radius}, std::nullopt);
    return options;
}

Result<planning::ExplorationOptions> exploration_options(const boost::json::object& body,
                                                         const std::optional<double>& own) {
    planning::ExplorationOptions options;
    if (const auto* size = body.if_contains("size_min")) {
        if (!size->is_int64() || size->get_int64() < 1) {
            return invalid("size_min is no whole number of cells from 1 on");
        }
        options.frontier_size_min = static_cast<std::size_t>(size->get_int64());
    }
    const auto radius = read_number(body, "body_radius");
    if (!radius) return radius.error();
    options.passability = guidance::passability_of({.radius = *radius}, own);
    return options;
}

Result<guidance::RequestedBody> requested_body(const boost::json::object& body) {
    guidance::RequestedBody requested;
    if (const auto* value = body.if_contains("allow_unknown")) {
        if (!value->is_bool()) return invalid("allow_unknown is neither true nor false");
        requested.allow_unknown = value->get_bool();
    }
    const auto radius = read_number(body, "body_radius");
    if (!radius) return radius.error();
    requested.radius = *radius;
    const auto danger_cost = read_number(body, "danger_cost");
    if (!danger_cost) return danger_cost.error();
    requested.danger_cost = *danger_cost;
    return requested;
}

Result<Point2> read_point(const boost::json::value& value, std::string_view name) {
    if (!value.is_array() || value.get_array().size() != 2) {
        return invalid(fmt::format("{} is not a point; give [x, y] in metres", name));
    }
    const auto x = read_coordinate(value.get_array()[0], fmt::format("{}[0]", name));
    if (!x) return x.error();
    const auto y = read_coordinate(value.get_array()[1], fmt::format("{}[1]", name));
    if (!y) return y.error();
    return Point2{*x, *y};
}

Result<guidance::Start> read_start(const boost::json::value& value, std::string_view name,
                                   const mapping::Snapshot& maps) {
    if (!value.is_object()) {
        if (!value.is_array()) return invalid(fmt::format(R"({} is neither [x, y] nor {{"robot": "name"}})", name));
        const auto point = read_point(value, name);
        if (!point) return point.error();
        return guidance::Start{*point};
    }
    constexpr std::array<std::string_view, 1> kKnown = {"robot"};
    const auto within = fmt::format("{}: ", name);
    if (auto ok = check_members(value.get_object(), kKnown); !ok) return prefixed(within, ok.error());
    const auto robot = read_text(value.get_object(), "robot");
    if (!robot) return prefixed(within, robot.error());
    const auto index = guidance::find_robot(maps, *robot);
    if (!index) return prefixed(fmt::format("{} is robot {}: ", name, in_quotes(*robot)), index.error());
    const auto start = guidance::start_of(maps, *index);
    if (!start) return prefixed(within, start.error());
    return start;
}

Result<std::vector<Point2>> read_region(const boost::json::value& value, std::string_view name) {
    const auto* corners = value.if_array();
    if (corners == nullptr) {
        return invalid(
            fmt::format("{} is neither a polygon [[x, y], ...] nor a box [min_x, min_y, max_x, max_y]", name));
    }
    if (corners->size() == 4 && std::ranges::none_of(*corners, [](const auto& one) { return one.is_array(); })) {
        return read_box(*corners, name);
    }
    if (corners->size() < 3 || corners->size() > planning::kRegionCornersMax) {
        return invalid(fmt::format("{} has {} corners; a polygon of 3 to {} is needed, or a box [min_x, min_y, max_x, "
                                   "max_y]",
                                   name, corners->size(), planning::kRegionCornersMax));
    }
    std::vector<Point2> polygon;
    for (const auto& corner : *corners) {
        const auto point = read_point(corner, fmt::format("{}[{}]", name, polygon.size()));
        if (!point) return point.error();
        polygon.push_back(*point);
    }
    return polygon;
}

} // namespace scanloom::http
