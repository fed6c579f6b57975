#include "server/http/handlers/handlers.hpp"

#include "server/http/geojson.hpp"
#include "server/http/handlers/parameters.hpp"
#include "server/http/handlers/planning_request.hpp"
#include "server/http/json_read.hpp"
#include "server/http/text.hpp"
#include "server/sessions/stored_trajectories.hpp"
#include "server/sockets/worker_pool.hpp"

#include <boost/json/object.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scanloom::http {
namespace {

using localization::Estimate;
using localization::StampedPose;

constexpr std::size_t kTumLineBytes = 110;
constexpr std::size_t kEdgeTextBytes = 260;

std::optional<Estimate> parse_estimate(std::string_view text) {
    return text == "online" ? std::optional(Estimate::kFirst) : std::nullopt;
}

/// Calls `read` with the estimated poses of the session, on its strand.
/// @return its result
template <class Value, class Read>
boost::asio::awaitable<Value> read_poses(sessions::Session& session, Read read) {
    co_return co_await sockets::resume_with<Value>([&](auto done) {
        session.read_poses([done, read](const localization::SessionPoses& poses) { done(read(poses)); });
    });
}

/// Appends the scans of a robot that sends poses.
void append_sent(const std::vector<mapping::TrajectoryPoint>& old, const mapping::TrajectoryView& kept,
                 std::vector<StampedPose>& poses) {
    for (const auto& point : old) poses.push_back({point.stamp, point.pose});
    for (std::size_t n = kept.first_after(0); n < kept.size(); ++n) poses.push_back({kept[n].stamp, kept[n].pose});
}

void append_tum(std::string& text, const std::string& robot, std::vector<StampedPose> poses) {
    std::ranges::stable_sort(poses, {}, &StampedPose::stamp);
    fmt::format_to(std::back_inserter(text), "# robot {}\n", robot);
    for (const auto& [stamp, pose] : poses) {
        fmt::format_to(std::back_inserter(text), "{:.6f} {:.6f} {:.6f} 0 0 0 {:.9f} {:.9f}\n", stamp, pose.x, pose.y,
                       std::sin(pose.yaw / 2.0), std::cos(pose.yaw / 2.0));
    }
}

using Trajectories = std::shared_ptr<const std::vector<std::vector<StampedPose>>>;

} // namespace

boost::asio::awaitable<Result<Response>> get_trajectory_tum(Context& context) {
    const auto estimate = parameter(context.query, "as", Estimate::kNewest, parse_estimate, "online is possible");
    if (!estimate) co_return estimate.error();
    const auto& session = context.session;
    const auto snapshot = session->snapshot();
    std::optional<RobotIndex> wanted;
    if (const auto name = context.query.find("robot")) {
        const auto robot = robot_named(*snapshot, *name);
        if (!robot) co_return robot.error();
        wanted = *robot;
    }
    // A named variable, because g++ 12 destroys such temporaries twice
    const auto read = [robots = snapshot->robots.size(), as = *estimate,
                       exclusions = snapshot->exclusions](const localization::SessionPoses& poses) {
        std::vector<std::vector<StampedPose>> all(robots);
        for (RobotIndex robot = 0; robot < robots; ++robot) all[robot] = poses.trajectory(robot, as, *exclusions);
        return std::make_shared<const std::vector<std::vector<StampedPose>>>(std::move(all));
    };
    const auto estimated = co_await read_poses<Trajectories>(*session, read);
    std::size_t lines = 0;
    for (std::size_t n = 0; n < snapshot->robots.size(); ++n)
        lines += (*estimated)[n].size() + snapshot->robots[n].trajectory.size();
    auto permit = context.services.responses.take(lines * kTumLineBytes);
    if (!permit) co_return permit.error();
    const auto old = sessions::read_old_paths(
        context.services.log, session->info().id, *snapshot, 0,
        [&] { return !context.services.sessions.is_draining(); }, lines + 1);
    if (!old) co_return old.error();
    std::string text;
    for (std::size_t n = 0; n < snapshot->robots.size(); ++n) {
        if (wanted && *wanted != n) continue;
        const auto& robot = snapshot->robots[n];
        auto poses = (*estimated)[n];
        if (robot.poses == Poses::kMap) append_sent(old->robots[n], robot.trajectory, poses);
        append_tum(text, robot.name, std::move(poses));
    }
    co_return ok_text("text/plain; charset=utf-8", std::move(*permit), std::move(text));
}

namespace {

using Graph = std::shared_ptr<const localization::PoseGraphView>;

void append_keyframes(const localization::PoseGraphView& graph, const mapping::Snapshot& maps,
                      std::vector<std::string>& features) {
    for (std::size_t n = 0; n < graph.keyframes.size(); ++n) {
        const auto& [robot, pose, is_located] = graph.keyframes[n];
        if (!is_located || robot >= maps.robots.size()) continue;
        const boost::json::object properties{
            {"kind", "keyframe"}, {"robot", maps.robots[robot].name}, {"keyframe", n}, {"yaw", pose.yaw}};
        features.push_back(feature(properties, point_geometry({pose.x, pose.y})));
    }
}

void append_edges(const localization::PoseGraphView& graph, const mapping::Snapshot& maps,
                  std::vector<std::string>& features) {
    for (const auto& edge : graph.edges) {
        const auto& from = graph.keyframes[edge.from].pose;
        const auto& [robot, to, is_located] = graph.keyframes[edge.to];
        if (!is_located || robot >= maps.robots.size()) continue;
        const Pose2 measured = compose(from, scan_matching::pose_of(edge.T_from_to));
        const boost::json::object properties{
            {"kind", edge.is_robust ? "loop" : "match"},
            {"robot", maps.robots[robot].name},
            {"from", edge.from},
            {"to", edge.to},
            {"residual", rounded_metres(std::hypot(measured.x - to.x, measured.y - to.y))},
            {"residual_yaw", normalize_angle(measured.yaw - to.yaw)},
            {"is_used", edge.weight >= slam::kUsedWeight}};
        const std::vector<Point2> line{{from.x, from.y}, {to.x, to.y}};
        features.push_back(feature(properties, line_string(line)));
    }
}

} // namespace

boost::asio::awaitable<Result<Response>> get_pose_graph(Context& context) {
    const auto& session = context.session;
    const auto snapshot = session->snapshot();
    const auto graph = co_await read_poses<Graph>(*session, [](const localization::SessionPoses& poses) {
        return std::make_shared<const localization::PoseGraphView>(poses.graph());
    });
    const std::size_t parts = graph->keyframes.size() + graph->edges.size();
    auto permit = context.services.responses.take(parts * kEdgeTextBytes);
    if (!permit) co_return permit.error();
    std::vector<std::string> features;
    features.reserve(parts);
    append_keyframes(*graph, *snapshot, features);
    append_edges(*graph, *snapshot, features);
    auto text = collection_document(snapshot->revision, {}, features);
    co_return ok_text("application/geo+json", std::move(*permit), std::move(text));
}

namespace {

constexpr double kRadius = 10.0;      // metres, if the request states none
constexpr double kRadiusMax = 1000.0; // metres

/// Reads where a robot is.
Result<RobotRelocalized> read_relocalized(const boost::json::object& body, const mapping::Snapshot& maps) {
    const auto name = read_text(body, "robot");
    if (!name) return name.error();
    const auto robot = robot_named(maps, *name);
    if (!robot) return robot.error();
    const auto* place = body.if_contains("near");
    if (place == nullptr) return Error{Errc::kInvalidField, "near is missing; give [x, y] in metres of the map frame"};
    const auto near = read_point(*place, "near");
    if (!near) return near.error();
    const auto radius = read_number(body, "radius");
    if (!radius) return radius.error();
    const double metres = radius->value_or(kRadius);
    if (metres > 0.0 && metres <= kRadiusMax) return RobotRelocalized{*robot, *near, metres};
    return Error{Errc::kInvalidField,
                 fmt::format("radius is {}; give metres, above 0 and at most {}", metres, kRadiusMax)};
}

} // namespace

boost::asio::awaitable<Result<Response>> relocalize(Context& context) {
    const auto body = parse_json_object(context.request.body, {"robot", "near", "radius"});
    if (!body) co_return body.error();
    const auto relocalized = read_relocalized(*body, *context.session->snapshot());
    if (!relocalized) co_return relocalized.error();
    const auto taken = co_await sockets::resume_with<Result<>>(
        [&](auto done) { context.session->relocalize(*relocalized, std::move(done)); });
    if (!taken) co_return taken.error();
    Response response = ok(boost::json::object{
        {"robot", body->at("robot")}, {"near", position(relocalized->near)}, {"radius", relocalized->radius}});
    response.status = Status::accepted;
    co_return response;
}

boost::asio::awaitable<Result<Response>> change_mode(Context& context) {
    const auto body = parse_json_object(context.request.body, {"localize_only"});
    if (!body) co_return body.error();
    const auto localize_only = read_flag(*body, "localize_only");
    if (!localize_only) co_return localize_only.error();
    if (!*localize_only) co_return Error{Errc::kInvalidField, "localize_only is missing; give true or false"};
    const ModeChanged changed{**localize_only};
    const auto taken = co_await sockets::resume_with<Result<>>(
        [&](auto done) { context.session->change_mode(changed, std::move(done)); });
    if (!taken) co_return taken.error();
    Response response = ok(boost::json::object{{"localize_only", changed.is_localize_only}});
    response.status = Status::accepted;
    co_return response;
}

} // namespace scanloom::http
