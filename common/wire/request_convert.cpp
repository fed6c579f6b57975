#include "common/wire/request_convert.hpp"

#include "common/scan/limits.hpp"
#include "common/wire/error_codes.hpp"
#include "common/wire/proto_convert.hpp"

#include <fmt/format.h>
#include <google/protobuf/repeated_field.h>

#include <cmath>
#include <cstdlib>
#include <initializer_list>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>

namespace scanloom::wire {
namespace {

using Coordinates = google::protobuf::RepeatedField<double>;

constexpr auto kMillimetresMax = static_cast<std::int64_t>(kCoordinateMax * 1e3);
constexpr double kRadiusMax = 1000.0; // metres

/// Reads a required point.
Result<> read_point(std::string_view field, const v1::Point& proto, Point2& point) {
    if (auto ok = check_coordinate("x", proto.x()); !ok) return prefixed(field, ok.error());
    if (auto ok = check_coordinate("y", proto.y()); !ok) return prefixed(field, ok.error());
    point = {proto.x(), proto.y()};
    return {};
}

template <class Request>
Result<> read_start(const Request& proto, std::optional<Point2>& start) {
    return proto.has_start() ? read_point("start.", proto.start(), start.emplace()) : Result<>();
}

/// Checks that lengths, costs or areas are finite and not negative.
Result<> check_sizes(std::initializer_list<std::pair<std::string_view, double>> sizes) {
    for (const auto& [field, size] : sizes) {
        if (std::isfinite(size) && size >= 0.0) continue;
        return invalid_field(fmt::format("{} is {}; a finite number from 0 on is needed", field, size));
    }
    return {};
}

/// Checks the number of points in a list of their coordinates.
Result<> check_count(std::string_view field, int numbers, std::size_t points_max, std::size_t points_min = 0) {
    const auto count = static_cast<std::size_t>(numbers);
    if (count % 2 != 0) {
        return invalid_field(fmt::format("{} has {} numbers; each point has an x and a y", field, count));
    }
    if (count / 2 > points_max) {
        return Error{Errc::kTooLarge,
                     fmt::format("{} has {} points, at most {} are allowed", field, count / 2, points_max)};
    }
    if (count / 2 >= points_min) return {};
    return invalid_field(fmt::format("{} has {} points; at least {} are needed", field, count / 2, points_min));
}

Result<> read_points(std::string_view field, const Coordinates& proto, std::size_t points_max,
                     std::vector<Point2>& points) {
    if (auto ok = check_count(field, proto.size(), points_max); !ok) return ok;
    for (int n = 0; n < proto.size(); ++n) {
        if (auto ok = check_coordinate(fmt::format("{}[{}]", field, n), proto[n]); !ok) return ok;
    }
    points.reserve(static_cast<std::size_t>(proto.size()) / 2);
    for (int n = 0; n < proto.size(); n += 2) points.push_back({proto[n], proto[n + 1]});
    return {};
}

Result<> read_points(const Differences& proto, std::vector<PointMm>& points) {
    if (auto ok = check_count("points", proto.size(), kViewPointsMax, kViewPointsMin); !ok) return ok;
    points.reserve(static_cast<std::size_t>(proto.size()) / 2);
    std::int64_t at[2] = {0, 0};
    for (int n = 0; n < proto.size(); ++n) {
        std::int64_t& millimetres = at[n % 2];
        millimetres += proto[n];
        if (std::abs(millimetres) > kMillimetresMax) {
            return invalid_field(fmt::format("points[{}] leads to {} mm; at most {} either way is allowed", n,
                                             millimetres, kMillimetresMax));
        }
        if (n % 2 == 1) points.push_back({static_cast<std::int32_t>(at[0]), static_cast<std::int32_t>(at[1])});
    }
    return {};
}

Result<> read_near(const v1::LocateRequest& proto, std::optional<Near>& near) {
    if (!proto.has_near()) {
        if (proto.radius() == 0.0) return {};
        return invalid_field("radius is given, but near is not; give the centre in near");
    }
    near.emplace().radius = proto.radius();
    if (auto ok = read_point("near.", proto.near(), near->point); !ok) return ok;
    if (near->radius > 0.0 && near->radius <= kRadiusMax) return {};
    return invalid_field(
        fmt::format("radius is {} m; it must be more than 0 and at most {}", near->radius, kRadiusMax));
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

void write_point(const Point2& point, v1::Point& out) {
    out.set_x(point.x);
    out.set_y(point.y);
}

void write_points(const std::vector<Point2>& points, Coordinates& out) {
    out.Reserve(static_cast<int>(2 * points.size()));
    for (const Point2& point : points) {
        out.Add(point.x);
        out.Add(point.y);
    }
}

} // namespace

// Results -------------------------------------------------------------------------------------------------------------

static Result<Path> from_proto(const v1::Path& proto) {
    Path path;
    if (auto ok = read_points("points", proto.points(), kReplyPointsMax, path.points); !ok) return ok.error();
    if (path.points.empty()) return invalid_field("points is empty; a path has at least 1 point");
    if (auto ok = check_sizes({{"length", proto.length()}, {"cost", proto.cost()}}); !ok) return ok.error();
    path.length = proto.length();
    path.cost = proto.cost();
    return path;
}

static void to_proto(const Path& path, v1::Path& out) {
    write_points(path.points, *out.mutable_points());
    out.set_length(path.length);
    out.set_cost(path.cost);
}

static Result<Goal> from_proto(const v1::Goal& proto) {
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
    auto path = from_proto(proto.path());
    if (!path) return prefixed("path.", path.error());
    goal.path = std::move(*path);
    if (auto ok = read_point("target.", proto.target(), goal.target.emplace()); !ok) return ok.error();
    return goal;
}

static void to_proto(const Goal& goal, v1::Goal& out) {
    out.set_exploration(static_cast<v1::Exploration>(goal.exploration));
    if (goal.path) to_proto(*goal.path, *out.mutable_path());
    if (goal.target) write_point(*goal.target, *out.mutable_target());
    out.set_given_up(goal.given_up);
    out.set_in_danger(goal.in_danger);
}

static Result<Coverage> from_proto(const v1::Coverage& proto) {
    auto path = from_proto(proto.path());
    if (!path) return prefixed("path.", path.error());
    if (auto ok = check_sizes({{"free_area", proto.free_area()},
                               {"covered_area", proto.covered_area()},
                               {"cell_size", proto.cell_size()}});
        !ok) {
        return ok.error();
    }
    auto runs = read_runs(proto.unreachable());
    if (!runs) return runs.error();
    return Coverage{std::move(*path), proto.free_area(), proto.covered_area(), std::move(*runs), proto.cell_size()};
}

static void to_proto(const Coverage& coverage, v1::Coverage& out) {
    to_proto(coverage.path, *out.mutable_path());
    out.set_free_area(coverage.free_area);
    out.set_covered_area(coverage.covered_area);
    for (const CellRun& run : coverage.unreachable) {
        out.add_unreachable(run.j);
        out.add_unreachable(run.i);
        out.add_unreachable(run.count);
    }
    out.set_cell_size(coverage.cell_size);
}

Result<Correction> from_proto(const v1::Correction& proto) {
    auto pose = from_proto(proto.t_map_odom());
    if (!pose) return prefixed("T_map_odom.", pose.error());
    if (!(proto.explained() >= 0.0 && proto.explained() <= 1.0)) {
        return invalid_field(fmt::format("explained is {}; a part from 0 to 1 is needed", proto.explained()));
    }
    if (auto ok = check_sizes({{"position_sigma", proto.position_sigma()}, {"yaw_sigma", proto.yaw_sigma()}}); !ok) {
        return ok.error();
    }
    if (proto.has_mount_yaw_error() && !(std::fabs(proto.mount_yaw_error()) <= std::numbers::pi)) {
        return invalid_field(
            fmt::format("mount_yaw_error is {}; radians from -pi to pi are needed", proto.mount_yaw_error()));
    }
    const bool is_known = v1::LocalizationState_IsValid(proto.state());
    return Correction{*pose,
                      proto.revision(),
                      proto.explained(),
                      proto.position_sigma(),
                      proto.yaw_sigma(),
                      is_known ? static_cast<LocalizationState>(proto.state()) : LocalizationState::kGiven,
                      proto.has_mount_yaw_error() ? std::optional(proto.mount_yaw_error()) : std::nullopt};
}

void to_proto(const Correction& correction, v1::Correction& out) {
    to_proto(correction.T_map_odom, *out.mutable_t_map_odom());
    out.set_revision(correction.revision);
    out.set_explained(correction.explained);
    out.set_position_sigma(correction.position_sigma);
    out.set_yaw_sigma(correction.yaw_sigma);
    out.set_state(static_cast<v1::LocalizationState>(correction.state));
    if (correction.mount_yaw_error) out.set_mount_yaw_error(*correction.mount_yaw_error);
}

// Requests ------------------------------------------------------------------------------------------------------------

Result<PlanRequest> from_proto(const v1::PlanRequest& proto) {
    PlanRequest request;
    request.id = proto.id();
    if (auto ok = read_start(proto, request.start); !ok) return ok.error();
    if (!proto.has_goal()) return invalid_field("goal is absent; a point is needed");
    if (auto ok = read_point("goal.", proto.goal(), request.goal); !ok) return ok.error();
    request.allow_unknown = proto.allow_unknown();
    if (proto.has_body_radius()) request.body_radius = proto.body_radius();
    if (proto.has_danger_cost()) request.danger_cost = proto.danger_cost();
    return request;
}

void to_proto(const PlanRequest& request, v1::PlanRequest& out) {
    out.set_id(request.id);
    if (request.start) write_point(*request.start, *out.mutable_start());
    write_point(request.goal, *out.mutable_goal());
    out.set_allow_unknown(request.allow_unknown);
    if (request.body_radius) out.set_body_radius(*request.body_radius);
    if (request.danger_cost) out.set_danger_cost(*request.danger_cost);
}

Result<GoalRequest> from_proto(const v1::GoalRequest& proto) {
    GoalRequest request;
    request.id = proto.id();
    if (auto ok = read_start(proto, request.start); !ok) return ok.error();
    if (proto.has_body_radius()) request.body_radius = proto.body_radius();
    request.frontier_size_min = proto.frontier_size_min();
    return request;
}

void to_proto(const GoalRequest& request, v1::GoalRequest& out) {
    out.set_id(request.id);
    if (request.start) write_point(*request.start, *out.mutable_start());
    if (request.body_radius) out.set_body_radius(*request.body_radius);
    out.set_frontier_size_min(request.frontier_size_min);
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

void to_proto(const CoverageRequest& request, v1::CoverageRequest& out) {
    out.set_id(request.id);
    if (request.start) write_point(*request.start, *out.mutable_start());
    if (request.body_radius) out.set_body_radius(*request.body_radius);
    if (request.spacing) out.set_spacing(*request.spacing);
    write_points(request.region, *out.mutable_region());
}

Result<LocateRequest> from_proto(const v1::LocateRequest& proto) {
    LocateRequest request;
    request.id = proto.id();
    if (auto ok = read_points(proto.points(), request.points); !ok) return ok.error();
    if (proto.has_from()) {
        if (auto ok = read_point("from.", proto.from(), request.from); !ok) return ok.error();
    }
    if (auto ok = read_near(proto, request.near); !ok) return ok.error();
    return request;
}

void to_proto(const LocateRequest& request, v1::LocateRequest& out) {
    out.set_id(request.id);
    append_differences(request.points, *out.mutable_points());
    write_point(request.from, *out.mutable_from());
    if (!request.near) return;
    write_point(request.near->point, *out.mutable_near());
    out.set_radius(request.near->radius);
}

// Replies -------------------------------------------------------------------------------------------------------------

namespace {

/// Reads a reply whose message has the result in `field`.
template <class T, class Proto, class Value>
Result<ReplyOf<T>> read_reply(const Proto& proto, std::string_view field, const Value* value) {
    if (proto.has_refusal()) {
        const v1::Refusal& refusal = proto.refusal();
        return ReplyOf<T>{proto.id(), proto.revision(), Error{to_errc(refusal.code()), refusal.message()}};
    }
    if (value == nullptr) return invalid_field("outcome is absent; a reply has a result or an error");
    auto result = from_proto(*value);
    if (!result) return prefixed(field, result.error());
    return ReplyOf<T>{proto.id(), proto.revision(), std::move(*result)};
}

/// @param mutable_value  protobuf's function that returns where to write the result
template <class T, class Proto, class Value>
void write_reply(const ReplyOf<T>& reply, Proto& out, Value* (Proto::*mutable_value)()) {
    out.set_id(reply.id);
    out.set_revision(reply.revision);
    if (reply.result) return to_proto(*reply.result, *(out.*mutable_value)());
    out.mutable_refusal()->set_code(to_code(reply.result.error().code));
    out.mutable_refusal()->set_message(reply.result.error().message);
}

} // namespace

Result<PlanReply> from_proto(const v1::PlanReply& proto) {
    return read_reply<Path>(proto, "path.", proto.has_path() ? &proto.path() : nullptr);
}

Result<GoalReply> from_proto(const v1::GoalReply& proto) {
    return read_reply<Goal>(proto, "goal.", proto.has_goal() ? &proto.goal() : nullptr);
}

Result<CoverageReply> from_proto(const v1::CoverageReply& proto) {
    return read_reply<Coverage>(proto, "coverage.", proto.has_coverage() ? &proto.coverage() : nullptr);
}

Result<LocateReply> from_proto(const v1::LocateReply& proto) {
    return read_reply<Correction>(proto, "correction.", proto.has_correction() ? &proto.correction() : nullptr);
}

void to_proto(const PlanReply& reply, v1::PlanReply& out) { write_reply(reply, out, &v1::PlanReply::mutable_path); }
void to_proto(const GoalReply& reply, v1::GoalReply& out) { write_reply(reply, out, &v1::GoalReply::mutable_goal); }
void to_proto(const CoverageReply& reply, v1::CoverageReply& out) {
    write_reply(reply, out, &v1::CoverageReply::mutable_coverage);
}
void to_proto(const LocateReply& reply, v1::LocateReply& out) {
    write_reply(reply, out, &v1::LocateReply::mutable_correction);
}

} // namespace scanloom::wire
