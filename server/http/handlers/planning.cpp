#include "server/http/handlers/handlers.hpp"

#include "core/planning/coverage.hpp"
#include "core/planning/goals.hpp"
#include "core/planning/grid_path.hpp"
#include "server/guidance/plans.hpp"
#include "server/http/geojson.hpp"
#include "server/http/handlers/parameters.hpp"
#include "server/http/handlers/planning_request.hpp"
#include "server/http/json_read.hpp"
#include "server/http/text.hpp"

#include <boost/json/array.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::http {
namespace {

Result<boost::json::object> parse_plan(std::string_view text) {
    auto body = parse_json_object(text, {"from", "to", "allow_unknown", "body_radius", "danger_cost"});
    if (!body) return body;
    for (const char* name : {"from", "to"}) {
        if (!body->contains(name)) {
            return Error{Errc::kInvalidField, fmt::format("{} is missing; give [x, y] in metres", name)};
        }
    }
    return body;
}

} // namespace

Result<Response> post_plan(Context& context) {
    const auto found = find_for_search(context);
    if (!found) return found.error();
    const auto& snapshot = *found->snapshot;
    const auto body = parse_plan(context.request.body);
    if (!body) return body.error();
    const auto to = read_point(body->at("to"), "to");
    if (!to) return to.error();
    const auto from = read_start(body->at("from"), "from", snapshot);
    if (!from) return from.error();
    const auto requested = requested_body(*body);
    if (!requested) return requested.error();

    const auto path = guidance::plan_path(snapshot, *from, *to, *requested);
    if (!path) return path.error();
    const boost::json::object properties{{"length", rounded_metres(path->length_m)},
                                         {"cost", rounded_metres(path->cost)}};
    return ok_text(kGeoJson, context.services.responses.take(path->points.size() * kPointTextBytes),
                   [&] { return feature_document(snapshot.revision, properties, line_string(path->points)); });
}

namespace {

Result<guidance::Start> coverage_start(const boost::json::object& body, const mapping::Snapshot& maps) {
    if (const auto* start = body.if_contains("start")) return read_start(*start, "start", maps);
    if (maps.robots.size() == 1) {
        const auto start = guidance::start_of(maps, 0);
        if (!start) return prefixed("start is missing: ", start.error());
        return start;
    }
    return Error{Errc::kInvalidField, fmt::format(R"(start is missing, and the session has {} robots; give [x, y] or )"
                                                  R"({{"robot": "name"}})",
                                                  maps.robots.size())};
}

Result<guidance::CoverageRequest> coverage_request(const boost::json::object& body) {
    guidance::CoverageRequest request;
    const auto radius = read_number(body, "body_radius");
    if (!radius) return radius.error();
    request.body_radius = *radius;
    const auto spacing = read_number(body, "spacing");
    if (!spacing) return spacing.error();
    request.spacing = *spacing;
    if (const auto* given = body.if_contains("region")) {
        auto region = read_region(*given, "region");
        if (!region) return region.error();
        request.region = std::move(*region);
    }
    return request;
}

std::string document_of(const mapping::Snapshot& maps, planning::Coverage&& coverage) {
    const double cell_size = maps.config.cell_size;
    const auto square_metres = [&](std::int64_t cells) {
        return rounded_metres(static_cast<double>(cells) * cell_size * cell_size);
    };
    const boost::json::object path{{"role", "path"},
                                   {"length", rounded_metres(coverage.path.length_m)},
                                   {"cost", rounded_metres(coverage.path.cost)},
                                   {"fraction", coverage.fraction},
                                   {"free_area", square_metres(coverage.free_cells)},
                                   {"covered_area", square_metres(coverage.covered_cells)},
                                   {"unreachable_area", rounded_metres(coverage.unreachable_m2)}};
    const boost::json::object unreachable{{"role", "unreachable"}, {"area", rounded_metres(coverage.unreachable_m2)}};
    const std::array features = {feature(path, line_string(coverage.path.points)),
                                 feature(unreachable, multi_polygon(std::move(coverage.unreachable), cell_size))};
    return collection_document(maps.revision, {}, features);
}

} // namespace

Result<Response> post_coverage(Context& context) {
    const auto found = find_for_search(context);
    if (!found) return found.error();
    const auto& snapshot = *found->snapshot;
    const auto body = parse_json_object(context.request.body, {"start", "spacing", "region", "body_radius"});
    if (!body) return body.error();
    const auto start = coverage_start(*body, snapshot);
    if (!start) return start.error();
    auto request = coverage_request(*body);
    if (!request) return request.error();

    auto coverage = guidance::plan_coverage(snapshot, *start, *std::move(request), context.services.sessions);
    if (!coverage) return coverage.error();
    const std::size_t bytes =
        coverage->path.points.size() * kPointTextBytes + coverage->unreachable.size() * kCellTextBytes;
    return ok_text(kGeoJson, context.services.responses.take(bytes),
                   [&] { return document_of(snapshot, std::move(*coverage)); });
}

namespace {

/// Limits the sequential searches, one from each robot. In a map of maximum size, this many cells take a few seconds.
constexpr std::int64_t kCellsSearchedMax = 4 * planning::kSearchCellsMax;

constexpr std::size_t kTextBytesMax = std::size_t{64} << 20;

Result<std::vector<RobotIndex>> robots_asked_for(const mapping::Snapshot& maps, const Query& query) {
    std::vector<RobotIndex> robots;
    if (const auto name = query.find("robot")) {
        const auto robot = robot_named(maps, *name);
        if (!robot) return robot.error();
        robots.push_back(*robot);
    } else {
        for (RobotIndex robot = 0; robot < maps.robots.size(); ++robot) robots.push_back(robot);
    }
    std::erase_if(robots, [&](RobotIndex robot) { return !maps.robots[robot].pose; });
    return robots;
}

Point2 place_of(const mapping::Snapshot& maps, RobotIndex robot) {
    const Pose2& pose = *maps.robots[robot].pose;
    return {pose.x, pose.y};
}

/// Checks that the search does not take too long. All robots must have a pose.
/// Errors: kInvalidField if it would.
Result<> check_cells_searched(const mapping::Snapshot& maps, const std::vector<RobotIndex>& robots,
                              const planning::ExplorationOptions& options) {
    if (robots.size() < 2) return {};
    std::int64_t searched = 0;
    for (const RobotIndex robot : robots) {
        const Point2 place = place_of(maps, robot);
        const auto window = planning::search_window(maps.classes, maps.config.cell_size,
                                                    {.body_radius_m = options.passability.body_radius_m}, {&place, 1});
        if (!window) return window.error();
        searched += window->search_cells;
    }
    if (searched <= kCellsSearchedMax) return {};
    return Error{Errc::kInvalidField,
                 fmt::format("robot is missing: the map is too large to search the paths of all {} robots; name one",
                             robots.size())};
}

/// The goal from which to explore a frontier, and the robot for it.
struct Offer {
    planning::FrontierGoal goal;
    RobotIndex robot;
};

struct Offers {
    std::vector<std::optional<Offer>> of_frontiers;
    std::vector<RobotIndex> robots; ///< that have a valid start
};

/// Returns the cheapest offer for each frontier. Ignores robots without a valid start. All robots must have a pose.
Result<Offers> cheapest_offers(const mapping::Snapshot& maps, const std::vector<classify::Frontier>& frontiers,
                               const std::vector<RobotIndex>& robots, const planning::ExplorationOptions& options) {
    Offers offers{std::vector<std::optional<Offer>>(frontiers.size()), {}};
    for (const RobotIndex robot : robots) {
        const auto goals =
            planning::frontier_goals(maps.classes, maps.config.cell_size, frontiers, place_of(maps, robot), options);
        if (!goals && goals.error().code != Errc::kNoPath) return goals.error();
        if (!goals) continue;
        offers.robots.push_back(robot);
        for (std::size_t n = 0; n < frontiers.size(); ++n) {
            auto& best = offers.of_frontiers[n];
            const auto& goal = (*goals)[n];
            if (goal && (!best || goal->cost < best->goal.cost)) best = Offer{*goal, robot};
        }
    }
    return offers;
}

std::string feature_of(const mapping::Snapshot& maps, const classify::Frontier& frontier,
                       const std::optional<Offer>& offer) {
    const double cell_size = maps.config.cell_size;
    const auto size = static_cast<double>(frontier.cells.size());
    boost::json::object properties{{"cells", frontier.cells.size()},
                                   {"area", rounded_metres(size * cell_size * cell_size)},
                                   {"centroid", position(Point2{frontier.centroid_x, frontier.centroid_y} * cell_size)},
                                   {"reachable", offer.has_value()},
                                   {"robot", nullptr},
                                   {"goal", nullptr},
                                   {"in_danger", nullptr},
                                   {"length", nullptr},
                                   {"cost", nullptr}};
    if (offer) {
        const auto& goal = offer->goal;
        properties["robot"] = maps.robots[offer->robot].name;
        properties["goal"] = position(Point2{goal.cell.i + 0.5, goal.cell.j + 0.5} * cell_size);
        properties["in_danger"] = goal.in_danger;
        properties["length"] = rounded_metres(goal.length_m);
        properties["cost"] = rounded_metres(goal.cost);
    }
    return feature(properties, multi_polygon(frontier.cells, cell_size));
}

} // namespace

Result<Response> get_frontiers(Context& context) {
    const auto found = find_for_search(context);
    if (!found) return found.error();
    const auto& snapshot = *found->snapshot;
    const auto options = exploration_options(context.query);
    if (!options) return options.error();
    const auto robots = robots_asked_for(snapshot, context.query);
    if (!robots) return robots.error();
    if (auto few = check_cells_searched(snapshot, *robots, *options); !few) return few.error();

    const auto frontiers = classify::find_frontiers(snapshot.classes, options->frontier_size_min.value_or(1));
    const auto offers = cheapest_offers(snapshot, frontiers, *robots, *options);
    if (!offers) return offers.error();
    std::size_t bytes = 0;
    for (const auto& frontier : frontiers) bytes += (frontier.cells.size() + 2) * kCellTextBytes;
    if (bytes > kTextBytesMax) {
        return Error{Errc::kTooLarge, fmt::format("these are {} frontiers, too many for an answer; give a larger "
                                                  "size_min, or use the tiles of classification",
                                                  frontiers.size())};
    }
    auto permit = context.services.responses.take(bytes);
    if (!permit) return permit.error();

    std::vector<std::string> features;
    for (std::size_t n = 0; n < frontiers.size(); ++n) {
        features.push_back(feature_of(snapshot, frontiers[n], offers->of_frontiers[n]));
    }
    boost::json::array names;
    for (const RobotIndex robot : offers->robots) names.emplace_back(snapshot.robots[robot].name);
    const bool any = std::ranges::any_of(offers->of_frontiers, [](const auto& one) { return one.has_value(); });
    return ok_text(
        kGeoJson, std::move(*permit),
        collection_document(snapshot.revision, {{"any_reachable", any}, {"robots", std::move(names)}}, features));
}

} // namespace scanloom::http
