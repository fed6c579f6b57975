#include "server/http/handlers/handlers.hpp"

#include "server/exchange/trajectory_text.hpp"
#include "server/http/geojson.hpp"
#include "server/http/handlers/parameters.hpp"
#include "server/http/handlers/planning_request.hpp"
#include "server/http/text.hpp"
#include "server/sessions/stored_trajectories.hpp"
#include "server/sockets/worker_pool.hpp"

#include <boost/json/object.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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

constexpr std::size_t kFeatureTextBytes = 260;
constexpr std::string_view kPlainText = "text/plain; charset=utf-8";

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

using Estimates = std::shared_ptr<const std::vector<std::vector<StampedPose>>>;

/// A robot's scans, sorted by stamp.
struct RobotTrajectory {
    std::string robot;
    std::vector<StampedPose> poses;
};

/// The requested trajectories.
struct Trajectories {
    limits::Semaphore::Permit permit; // for their text
    std::vector<RobotTrajectory> robots;
};

/// Reads the trajectory of the robot in the query, or of all.
boost::asio::awaitable<Result<Trajectories>> read_trajectories(const Context& context, const mapping::Snapshot& maps,
                                                               std::optional<RobotIndex> wanted) {
    const auto estimate = parameter(context.query, "as", Estimate::kNewest, parse_estimate, "online is possible");
    if (!estimate) co_return estimate.error();
    const auto& session = context.session;
    // A named variable, because g++ 12 destroys such temporaries twice
    const auto read = [robots = maps.robots.size(), as = *estimate,
                       exclusions = maps.exclusions](const localization::SessionPoses& poses) {
        std::vector<std::vector<StampedPose>> all(robots);
        for (RobotIndex robot = 0; robot < robots; ++robot) all[robot] = poses.trajectory(robot, as, *exclusions);
        return std::make_shared<const std::vector<std::vector<StampedPose>>>(std::move(all));
    };
    const auto estimated = co_await read_poses<Estimates>(*session, read);
    std::size_t lines = 0;
    for (std::size_t n = 0; n < maps.robots.size(); ++n)
        lines += (*estimated)[n].size() + maps.robots[n].trajectory.size();
    auto permit = context.services.responses.take(lines * exchange::kPoseTextBytes);
    if (!permit) co_return permit.error();
    const auto old = sessions::read_old_paths(
        context.services.log, session->info().id, maps, 0, [&] { return !context.services.sessions.is_draining(); },
        lines + 1);
    if (!old) co_return old.error();
    Trajectories trajectories{std::move(*permit), {}};
    for (std::size_t n = 0; n < maps.robots.size(); ++n) {
        if (wanted && *wanted != n) continue;
        const auto& robot = maps.robots[n];
        auto poses = (*estimated)[n];
        if (robot.poses == Poses::kMap) append_sent(old->robots[n], robot.trajectory, poses);
        std::ranges::stable_sort(poses, {}, &StampedPose::stamp);
        trajectories.robots.push_back({robot.name, std::move(poses)});
    }
    co_return trajectories;
}

/// Returns the robot in the query; nullopt: there is none.
Result<std::optional<RobotIndex>> wanted_robot(const Context& context, const mapping::Snapshot& maps) {
    const auto name = context.query.find("robot");
    if (!name) return std::nullopt;
    const auto robot = robot_named(maps, *name);
    if (!robot) return robot.error();
    return *robot;
}

} // namespace

boost::asio::awaitable<Result<Response>> get_trajectory_tum(Context& context) {
    const auto maps = context.session->snapshot();
    const auto wanted = wanted_robot(context, *maps);
    if (!wanted) co_return wanted.error();
    auto trajectories = co_await read_trajectories(context, *maps, *wanted);
    if (!trajectories) co_return trajectories.error();
    std::string text;
    for (const auto& [robot, poses] : trajectories->robots)
        text += fmt::format("# robot {}\n{}", robot, exchange::tum_text(poses));
    co_return ok_text(kPlainText, std::move(trajectories->permit), std::move(text));
}

boost::asio::awaitable<Result<Response>> get_trajectory_kitti(Context& context) {
    const auto maps = context.session->snapshot();
    const auto wanted = wanted_robot(context, *maps);
    if (!wanted) co_return wanted.error();
    if (!*wanted && maps->robots.size() > 1) {
        co_return Error{Errc::kInvalidField, fmt::format("robot is missing; the KITTI format has no names, and the "
                                                         "session has {} robots: request one at a time",
                                                         maps->robots.size())};
    }
    auto trajectories = co_await read_trajectories(context, *maps, *wanted);
    if (!trajectories) co_return trajectories.error();
    std::string text;
    for (const auto& trajectory : trajectories->robots) text += exchange::kitti_text(trajectory.poses);
    co_return ok_text(kPlainText, std::move(trajectories->permit), std::move(text));
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

boost::asio::awaitable<Graph> read_graph(const Context& context) {
    return read_poses<Graph>(*context.session, [](const localization::SessionPoses& poses) {
        return std::make_shared<const localization::PoseGraphView>(poses.graph());
    });
}

} // namespace

boost::asio::awaitable<Result<Response>> get_pose_graph(Context& context) {
    const auto snapshot = context.session->snapshot();
    const auto graph = co_await read_graph(context);
    const std::size_t parts = graph->keyframes.size() + graph->edges.size();
    auto permit = context.services.responses.take(parts * kFeatureTextBytes);
    if (!permit) co_return permit.error();
    std::vector<std::string> features;
    features.reserve(parts);
    append_keyframes(*graph, *snapshot, features);
    append_edges(*graph, *snapshot, features);
    auto text = collection_document(snapshot->revision, {}, features);
    co_return ok_text("application/geo+json", std::move(*permit), std::move(text));
}

boost::asio::awaitable<Result<Response>> get_pose_graph_g2o(Context& context) {
    const std::size_t robots = context.session->snapshot()->robots.size();
    const auto graph = co_await read_graph(context);
    const std::size_t parts = graph->keyframes.size() + graph->edges.size();
    auto permit = context.services.responses.take(parts * exchange::kEdgeTextBytes);
    if (!permit) co_return permit.error();
    co_return ok_text(kPlainText, std::move(*permit), exchange::g2o_text(*graph, robots));
}

} // namespace scanloom::http
