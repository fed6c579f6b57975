#include "server/http/handlers/handlers.hpp"

#include "common/scan/limits.hpp"
#include "server/guidance/plans.hpp"
#include "server/http/geojson.hpp"
#include "server/http/handlers/parameters.hpp"
#include "server/http/handlers/planning_request.hpp"
#include "server/http/json_read.hpp"
#include "server/http/text.hpp"

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scanloom::http {
namespace {

std::string_view name_of(planning::Exploration outcome) {
    switch (outcome) {
    case planning::Exploration::kGoal: return "goal";
    case planning::Exploration::kTakenByOthers: return "taken_by_others";
    case planning::Exploration::kComplete: return "complete";
    }
    return "";
}

std::string point_text(const Point2& point) {
    return fmt::format(R"({{"x":{},"y":{}}})", rounded_metres(point.x), rounded_metres(point.y));
}

std::string head_text(std::string_view robot, Revision revision, std::string_view outcome) {
    return fmt::format(R"({{"robot":"{}","revision":{},"outcome":"{}",)", robot, revision,
                       outcome); // names are [A-Za-z0-9_-]
}

constexpr std::string_view kNoGoal = R"("goal":null,"target":null,"in_danger":null,"path":null,"length":null)";

/// Describes a goal that has just been assigned.
std::string goal_text(std::string_view robot, const mapping::Snapshot& maps, const planning::NextGoal& next) {
    const auto head =
        head_text(robot, maps.revision, name_of(next.outcome)) + fmt::format(R"("given_up":{},)", next.given_up);
    if (!next.goal) return fmt::format(R"({}{},"cost":null}})", head, kNoGoal);
    const grid::Cell target = next.goal->target;
    return head + fmt::format(R"("goal":{},"target":{},"in_danger":{},"path":{},"length":{},"cost":{}}})",
                              point_text(next.path.points.back()),
                              point_text(Point2{target.i + 0.5, target.j + 0.5} * maps.config.cell_size),
                              next.goal->in_danger, line_string(next.path.points), rounded_metres(next.path.length_m),
                              rounded_metres(next.path.cost));
}

/// Describes a goal that was assigned earlier. If the robot has planned another path since, the goal has no path.
std::string goal_text(std::string_view robot, const guidance::Goal& goal, const guidance::HeldPath* path) {
    const bool leads_there = path != nullptr && path->kind == guidance::PathKind::kGoal;
    return head_text(robot, goal.revision, "goal") +
           fmt::format(R"("goal":{},"target":{},"in_danger":{},"path":{},"length":{}}})", point_text(goal.place),
                       point_text(goal.target), goal.in_danger, leads_there ? line_string(path->points) : "null",
                       leads_there ? fmt::to_string(rounded_metres(path->length_m)) : "null");
}

} // namespace

Result<Response> get_goal(Context& context) {
    const auto name = context.query.find("robot");
    if (!name) return Error{Errc::kInvalidField, "robot is missing; name the robot whose goal is asked for"};
    const auto maps = context.session->snapshot();
    const auto robot = robot_named(*maps, *name);
    if (!robot) return robot.error();

    const auto page = context.services.goals.paths().page(context.session, guidance::RobotPaths::Clock::now());
    const auto held = std::ranges::find(page.robots, *robot, &guidance::RobotPaths::Held::robot);
    if (held == page.robots.end() || !held->goal) {
        const bool explored = std::ranges::binary_search(page.explored, *robot);
        const auto head = head_text(*name, maps->revision, explored ? "complete" : "none");
        return ok_text(kJson, nullptr, fmt::format("{}{}}}", head, kNoGoal));
    }
    const std::size_t points = held->path ? held->path->points.size() : 0;
    return ok_text(kJson, context.services.responses.take(points * kPointTextBytes),
                   [&] { return goal_text(*name, *held->goal, held->path.get()); });
}

Result<Response> assign_goal(Context& context) {
    const auto found = find_for_search(context);
    if (!found) return found.error();
    const auto& snapshot = *found->snapshot;
    const auto body = parse_json_object(context.request.body, {"robot", "size_min", "body_radius"});
    if (!body) return body.error();
    const auto name = read_text(*body, "robot");
    if (!name) return name.error();
    const auto robot = robot_named(snapshot, *name);
    if (!robot) return robot.error();
    const auto options = exploration_options(*body, snapshot.robots[*robot].body_radius);
    if (!options) return options.error();
    const auto start = guidance::start_of(snapshot, *robot);
    if (!start) {
        context.services.goals.paths().take_back(found->session, *robot);
        return start.error();
    }

    const auto next = context.services.goals.next(found->session, snapshot, *robot, start->point,
                                                  guidance::GoalAssignments::Clock::now(), *options);
    if (!next) return next.error();
    return ok_text(kJson, context.services.responses.take(next->path.points.size() * kPointTextBytes),
                   [&] { return goal_text(*name, snapshot, *next); });
}

namespace {

std::string_view name_of(guidance::PathKind kind) {
    switch (kind) {
    case guidance::PathKind::kGoal: return "goal";
    case guidance::PathKind::kPlan: return "plan";
    case guidance::PathKind::kCoverage: return "coverage";
    }
    return "";
}

std::string feature_of(const std::string& robot, const guidance::HeldPath& path) {
    const boost::json::object properties{{"role", "way"},
                                         {"robot", robot},
                                         {"kind", name_of(path.kind)},
                                         {"length", rounded_metres(path.length_m)},
                                         {"points_left_out", path.points_left_out},
                                         {"revision", path.revision}};
    return feature(properties, line_string(path.points));
}

std::string feature_of(const std::string& robot, const guidance::Goal& goal) {
    const boost::json::object properties{{"role", "goal"},
                                         {"robot", robot},
                                         {"target", position(goal.target)},
                                         {"in_danger", goal.in_danger},
                                         {"revision", goal.revision}};
    return feature(properties, point_geometry(goal.place));
}

} // namespace

Result<Response> get_goals(Context& context) {
    const auto page = context.services.goals.paths().page(context.session, guidance::RobotPaths::Clock::now());
    std::size_t bytes = page.explored.size() * kNameBytesMax;
    for (const auto& held : page.robots) bytes += ((held.path ? held.path->points.size() : 0) + 16) * kPointTextBytes;
    auto permit = context.services.responses.take(bytes);
    if (!permit) return permit.error();

    const auto maps = context.session->snapshot();
    std::vector<std::string> features;
    for (const auto& held : page.robots) {
        if (held.robot >= maps->robots.size()) continue; // its join has not been applied to the maps yet
        const std::string& name = maps->robots[held.robot].name;
        if (held.path) features.push_back(feature_of(name, *held.path));
        if (held.goal) features.push_back(feature_of(name, *held.goal));
    }
    boost::json::array explored;
    for (const RobotIndex robot : page.explored) {
        if (robot < maps->robots.size()) explored.emplace_back(maps->robots[robot].name);
    }
    return ok_text(kGeoJson, std::move(*permit),
                   collection_document(page.revision, {{"explored", std::move(explored)}}, features));
}

} // namespace scanloom::http
