#include "server/http/handlers/goal.hpp"

#include "server/guide/robots.hpp"
#include "server/http/geojson.hpp"
#include "server/http/handlers/planning_request.hpp"
#include "server/http/in_quotes.hpp"
#include "server/http/number.hpp"

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <utility>

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

std::string goal_text(std::string_view robot, const mapping::Snapshot& maps, const planning::NextGoal& next) {
    const auto head = fmt::format(R"({{"robot":"{}","revision":{},"outcome":"{}","given_up":{},)", robot, maps.revision,
                                  name_of(next.outcome), next.given_up); // names are [A-Za-z0-9_-]
    if (!next.goal)
        return head + R"("goal":null,"target":null,"in_danger":null,"path":null,"length":null,"cost":null})";
    const grid::Cell target = next.goal->target;
    return head + fmt::format(R"("goal":{},"target":{},"in_danger":{},"path":{},"length":{},"cost":{}}})",
                              point_text(next.path.points.back()),
                              point_text(Point2{target.i + 0.5, target.j + 0.5} * maps.config.cell_size),
                              next.goal->in_danger, line_string(next.path.points), rounded_metres(next.path.length_m),
                              rounded_metres(next.path.cost));
}

} // namespace

Result<Response> get_goal(const MapsLookup& maps, guide::GoalBook& goals, const AnswerSlots& slots, const Call& call) {
    const auto found = find_for_search(maps, call, {"robot", "size_min", "body_radius"});
    if (!found) return found.error();
    const auto& snapshot = *found->snapshot;
    const auto name = call.query.find("robot");
    if (!name) return Error{Errc::kInvalidField, "robot is missing; name the robot that is to explore"};
    const auto robot = guide::find_robot(snapshot, *name);
    if (!robot) return prefixed(fmt::format("robot is {}: ", in_quotes(*name)), robot.error());
    const auto options = exploration_options(call.query, snapshot.robots[*robot].body_radius);
    if (!options) return options.error();
    const auto pose = guide::pose_of(snapshot, *robot);
    if (!pose) return pose.error();

    const auto next =
        goals.next(found->session, snapshot, *robot, Point2{pose->x, pose->y}, guide::GoalBook::Clock::now(), *options);
    if (!next) return next.error();
    auto slot = slots.take(next->path.points.size() * kPointTextBytes);
    if (!slot) return slot.error();
    return ok_text(kJson, std::move(*slot), goal_text(*name, snapshot, *next));
}

} // namespace scanloom::http
