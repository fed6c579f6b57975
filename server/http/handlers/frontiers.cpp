#include "server/http/handlers/frontiers.hpp"

#include "server/guide/robots.hpp"
#include "server/http/geojson.hpp"
#include "server/http/handlers/planning_request.hpp"
#include "server/http/in_quotes.hpp"
#include "server/http/number.hpp"
#include "server/planning/goals.hpp"

#include <boost/json/array.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::http {
namespace {

/// Limits the sequential searches, one from each robot. In a map of maximum size, this many cells take a few seconds.
constexpr std::int64_t kCellsSearchedMax = 4 * planning::kSearchCellsMax;

constexpr std::size_t kTextBytesMax = std::size_t{64} << 20;

Result<std::vector<RobotIndex>> robots_asked_for(const mapping::Snapshot& maps, const Query& query) {
    std::vector<RobotIndex> robots;
    if (const auto name = query.find("robot")) {
        const auto robot = guide::find_robot(maps, *name);
        if (!robot) return prefixed(fmt::format("robot is {}: ", in_quotes(*name)), robot.error());
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
    return Error{Errc::kInvalidField, fmt::format("robot is missing: the map is too large to look for the ways of "
                                                  "all {} robots; name one",
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

Result<Response> get_frontiers(const MapsLookup& maps, const AnswerSlots& slots, const Call& call) {
    const auto found = find_for_search(maps, call, {"robot", "size_min", "body_radius"});
    if (!found) return found.error();
    const auto& snapshot = *found->snapshot;
    const auto options = exploration_options(call.query);
    if (!options) return options.error();
    const auto robots = robots_asked_for(snapshot, call.query);
    if (!robots) return robots.error();
    if (auto few = check_cells_searched(snapshot, *robots, *options); !few) return few.error();

    const auto frontiers = classify::find_frontiers(snapshot.classes, options->frontier_size_min.value_or(1));
    const auto offers = cheapest_offers(snapshot, frontiers, *robots, *options);
    if (!offers) return offers.error();
    std::size_t bytes = 0;
    for (const auto& frontier : frontiers) bytes += (frontier.cells.size() + 2) * kCellTextBytes;
    if (bytes > kTextBytesMax) {
        return Error{Errc::kTooLarge, fmt::format("these are {} frontiers, too many for an answer; give a larger "
                                                  "size_min, or look at the tiles of classification",
                                                  frontiers.size())};
    }
    auto slot = slots.take(bytes);
    if (!slot) return slot.error();

    std::vector<std::string> features;
    for (std::size_t n = 0; n < frontiers.size(); ++n) {
        features.push_back(feature_of(snapshot, frontiers[n], offers->of_frontiers[n]));
    }
    boost::json::array names;
    for (const RobotIndex robot : offers->robots) names.emplace_back(snapshot.robots[robot].name);
    const bool any = std::ranges::any_of(offers->of_frontiers, [](const auto& one) { return one.has_value(); });
    return ok_text(
        kGeoJson, std::move(*slot),
        collection_document(snapshot.revision, {{"any_reachable", any}, {"robots", std::move(names)}}, features));
}

} // namespace scanloom::http
