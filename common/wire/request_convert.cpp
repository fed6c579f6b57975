#include "common/wire/request_convert.hpp"

#include "common/wire/point_convert.hpp"
#include "common/wire/proto_convert.hpp"

#include <fmt/format.h>
#include <google/protobuf/repeated_field.h>

#include <string>
#include <string_view>
#include <utility>

namespace scanloom::wire {
namespace {

using Coordinates = google::protobuf::RepeatedField<double>;

template <class Request>
Result<> read_start(const Request& proto, std::optional<Point2>& start) {
    if (!proto.has_start()) return {};
    if (auto ok = check("start", proto.start()); !ok) return ok;
    start = value_of(proto.start());
    return {};
}

Result<> read_points(std::string_view field, const Coordinates& proto, std::size_t points_max,
                     std::vector<Point2>& points) {
    const auto count = static_cast<std::size_t>(proto.size());
    if (count % 2 != 0) {
        return invalid_field(fmt::format("{} has {} numbers; each point has an x and a y", field, count));
    }
    if (count / 2 > points_max) {
        return Error{Errc::kTooLarge,
                     fmt::format("{} has {} points, at most {} are allowed", field, count / 2, points_max)};
    }
    for (int n = 0; n < proto.size(); ++n) {
        if (auto ok = check_coordinate(fmt::format("{}[{}]", field, n), proto[n]); !ok) return ok;
    }
    points.reserve(count / 2);
    for (int n = 0; n < proto.size(); n += 2) points.push_back({proto[n], proto[n + 1]});
    return {};
}

Result<Path> read_path(const v1::Path& proto) {
    Path path;
    if (auto ok = read_points("points", proto.points(), kPathPointsMax, path.points); !ok) return ok.error();
    if (path.points.empty()) return invalid_field("points is empty; a path has at least 1 point");
    if (auto ok = check_size("length", proto.length()); !ok) return ok.error();
    if (auto ok = check_size("cost", proto.cost()); !ok) return ok.error();
    path.length = proto.length();
    path.cost = proto.cost();
    return path;
}

Result<Goal> read_goal(const v1::Goal& proto) {
    Goal goal;
    switch (proto.exploration()) {
    case v1::EXPLORATION_GOAL: goal.exploration = Exploration::kGoal; break;
    case v1::EXPLORATION_TAKEN_BY_OTHERS: goal.exploration = Exploration::kTakenByOthers; break;
    case v1::EXPLORATION_COMPLETE: goal.exploration = Exploration::kComplete; break;
    default:
        return invalid_field(
            fmt::format("exploration is {}; this program does not know it", static_cast<int>(proto.exploration())));
    }
    const bool has_goal = goal.exploration == Exploration::kGoal;
    if (proto.has_path() != has_goal || proto.has_target() != has_goal) {
        return invalid_field("exploration does not go with path and target; a goal has both, anything else none");
    }
    goal.given_up = proto.given_up();
    goal.in_danger = proto.in_danger();
    if (!has_goal) return goal;
    auto path = read_path(proto.path());
    if (!path) return prefixed("path.", path.error());
    goal.path = std::move(*path);
    if (auto ok = check("target", proto.target()); !ok) return ok.error();
    goal.target = value_of(proto.target());
    return goal;
}

Result<std::vector<CellRun>> read_runs(const google::protobuf::RepeatedField<std::int32_t>& numbers) {
    if (numbers.size() % 3 != 0) {
        return invalid_field(fmt::format("unreachable has {} numbers; three for each run are needed", numbers.size()));
    }
    std::vector<CellRun> runs;
    for (int n = 0; n < numbers.size(); n += 3) {
        runs.push_back({numbers[n], numbers[n + 1], numbers[n + 2]});
        if (runs.back().count > 0) continue;
        return invalid_field(fmt::format("unreachable[{}] is {}; a run has at least one cell", n + 2, numbers[n + 2]));
    }
    return runs;
}

Result<Coverage> read_coverage(const v1::Coverage& proto) {
    auto path = read_path(proto.path());
    if (!path) return prefixed("path.", path.error());
    if (auto ok = check_size("free_area", proto.free_area()); !ok) return ok.error();
    if (auto ok = check_size("covered_area", proto.covered_area()); !ok) return ok.error();
    if (auto ok = check_size("cell_size", proto.cell_size()); !ok) return ok.error();
    auto runs = read_runs(proto.unreachable());
    if (!runs) return runs.error();
    return Coverage{std::move(*path), proto.free_area(), proto.covered_area(), std::move(*runs), proto.cell_size()};
}

void write(const std::vector<Point2>& points, Coordinates& out) {
    out.Reserve(static_cast<int>(2 * points.size()));
    for (const Point2& point : points) {
        out.Add(point.x);
        out.Add(point.y);
    }
}

void write(const Path& path, v1::Path& out) {
    write(path.points, *out.mutable_points());
    out.set_length(path.length);
    out.set_cost(path.cost);
}

void write(const Goal& goal, v1::Goal& out) {
    out.set_exploration(static_cast<v1::Exploration>(goal.exploration));
    if (goal.path) write(*goal.path, *out.mutable_path());
    if (goal.target) write_point(*goal.target, *out.mutable_target());
    out.set_given_up(goal.given_up);
    out.set_in_danger(goal.in_danger);
}

void write(const Coverage& coverage, v1::Coverage& out) {
    write(coverage.path, *out.mutable_path());
    out.set_free_area(coverage.free_area);
    out.set_covered_area(coverage.covered_area);
    for (const CellRun& run : coverage.unreachable) {
        out.add_unreachable(run.j);
        out.add_unreachable(run.i);
        out.add_unreachable(run.count);
    }
    out.set_cell_size(coverage.cell_size);
}

} // namespace

Result<PlanRequest> from_proto(const v1::PlanRequest& proto) {
    PlanRequest request;
    request.id = proto.id();
    if (auto ok = read_start(proto, request.start); !ok) return ok.error();
    if (!proto.has_goal()) return invalid_field("goal is absent; a point is needed");
    if (auto ok = check("goal", proto.goal()); !ok) return ok.error();
    request.goal = value_of(proto.goal());
    request.allow_unknown = proto.allow_unknown();
    if (proto.has_body_radius()) request.body_radius = proto.body_radius();
    if (proto.has_danger_cost()) request.danger_cost = proto.danger_cost();
    return request;
}

Result<PlanReply> from_proto(const v1::PlanReply& proto) {
    if (proto.has_refusal()) return PlanReply{proto.id(), proto.revision(), value_of(proto.refusal())};
    if (!proto.has_path()) return without_outcome();
    auto path = read_path(proto.path());
    if (!path) return prefixed("path.", path.error());
    return PlanReply{proto.id(), proto.revision(), std::move(*path)};
}

Result<GoalRequest> from_proto(const v1::GoalRequest& proto) {
    GoalRequest request;
    request.id = proto.id();
    if (auto ok = read_start(proto, request.start); !ok) return ok.error();
    if (proto.has_body_radius()) request.body_radius = proto.body_radius();
    request.frontier_size_min = proto.frontier_size_min();
    return request;
}

Result<GoalReply> from_proto(const v1::GoalReply& proto) {
    if (proto.has_refusal()) return GoalReply{proto.id(), proto.revision(), value_of(proto.refusal())};
    if (!proto.has_goal()) return without_outcome();
    auto goal = read_goal(proto.goal());
    if (!goal) return prefixed("goal.", goal.error());
    return GoalReply{proto.id(), proto.revision(), std::move(*goal)};
}

Result<CoverageRequest> from_proto(const v1::CoverageRequest& proto) {
    CoverageRequest request;
    request.id = proto.id();
    if (auto ok = read_start(proto, request.start); !ok) return ok.error();
    if (proto.has_body_radius()) request.body_radius = proto.body_radius();
    if (proto.has_spacing()) request.spacing = proto.spacing();
    if (auto ok = read_points("region", proto.region(), kRegionPointsMax, request.region); !ok) return ok.error();
    return request;
}

Result<CoverageReply> from_proto(const v1::CoverageReply& proto) {
    if (proto.has_refusal()) return CoverageReply{proto.id(), proto.revision(), value_of(proto.refusal())};
    if (!proto.has_coverage()) return without_outcome();
    auto coverage = read_coverage(proto.coverage());
    if (!coverage) return prefixed("coverage.", coverage.error());
    return CoverageReply{proto.id(), proto.revision(), std::move(*coverage)};
}

void to_proto(const PlanRequest& request, v1::PlanRequest& out) {
    out.set_id(request.id);
    if (request.start) write_point(*request.start, *out.mutable_start());
    write_point(request.goal, *out.mutable_goal());
    out.set_allow_unknown(request.allow_unknown);
    if (request.body_radius) out.set_body_radius(*request.body_radius);
    if (request.danger_cost) out.set_danger_cost(*request.danger_cost);
}

void to_proto(const PlanReply& reply, v1::PlanReply& out) {
    out.set_id(reply.id);
    out.set_revision(reply.revision);
    if (reply.path) {
        write(*reply.path, *out.mutable_path());
    } else {
        write_refusal(reply.path.error(), *out.mutable_refusal());
    }
}

void to_proto(const GoalRequest& request, v1::GoalRequest& out) {
    out.set_id(request.id);
    if (request.start) write_point(*request.start, *out.mutable_start());
    if (request.body_radius) out.set_body_radius(*request.body_radius);
    out.set_frontier_size_min(request.frontier_size_min);
}

void to_proto(const GoalReply& reply, v1::GoalReply& out) {
    out.set_id(reply.id);
    out.set_revision(reply.revision);
    if (reply.goal) {
        write(*reply.goal, *out.mutable_goal());
    } else {
        write_refusal(reply.goal.error(), *out.mutable_refusal());
    }
}

void to_proto(const CoverageRequest& request, v1::CoverageRequest& out) {
    out.set_id(request.id);
    if (request.start) write_point(*request.start, *out.mutable_start());
    if (request.body_radius) out.set_body_radius(*request.body_radius);
    if (request.spacing) out.set_spacing(*request.spacing);
    write(request.region, *out.mutable_region());
}

void to_proto(const CoverageReply& reply, v1::CoverageReply& out) {
    out.set_id(reply.id);
    out.set_revision(reply.revision);
    if (reply.coverage) {
        write(*reply.coverage, *out.mutable_coverage());
    } else {
        write_refusal(reply.coverage.error(), *out.mutable_refusal());
    }
}

} // namespace scanloom::wire
