#include "server/guidance/plans.hpp"

#include "server/guidance/robots.hpp"
#include "server/guidance/search_limit.hpp"

#include <utility>

namespace scanloom::guidance {

Result<Start> start_of(const mapping::Snapshot& maps, RobotIndex robot, const std::optional<Point2>& point) {
    const auto own = robot < maps.robots.size() ? maps.robots[robot].body_radius : std::nullopt;
    if (point) return Start{*point, own};
    const auto pose = pose_of(maps, robot);
    if (!pose) return pose.error();
    return Start{{pose->x, pose->y}, own};
}

planning::PassabilityOptions passability_of(const RequestedBody& requested, const std::optional<double>& own) {
    planning::PassabilityOptions options;
    options.body_radius_m = requested.radius.value_or(own.value_or(options.body_radius_m));
    options.danger_cost = requested.danger_cost.value_or(options.danger_cost);
    options.allow_unknown = requested.allow_unknown;
    options.on_known = !requested.allow_unknown;
    return options;
}

Result<planning::Path> plan_path(const mapping::Snapshot& maps, const Start& start, const Point2& to,
                                 const RequestedBody& body) {
    return planning::plan_path(maps.classes, maps.config.cell_size, start.point, to,
                               passability_of(body, start.body_radius));
}

Result<planning::Coverage> plan_coverage(const mapping::Snapshot& maps, const Start& start, CoverageRequest request,
                                         const sessions::SessionRegistry& sessions) {
    const planning::CoverageOptions options{passability_of({.radius = request.body_radius}, start.body_radius),
                                            request.spacing, std::move(request.region)};
    return planning::plan_coverage(maps.classes, maps.config.cell_size, start.point, options, SearchLimit(sessions));
}

} // namespace scanloom::guidance
