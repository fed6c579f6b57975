#include "server/http/handlers/handlers.hpp"

#include "server/http/geojson.hpp"
#include "server/http/handlers/parameters.hpp"
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
    const auto estimated = co_await read_poses<Trajectories>(
        *session, [robots = snapshot->robots.size(), as = *estimate](const localization::SessionPoses& poses) {
            std::vector<std::vector<StampedPose>> all(robots);
            for (RobotIndex robot = 0; robot < robots; ++robot) all[robot] = poses.trajectory(robot, as);
            return std::make_shared<const std::vector<std::vector<StampedPose>>>(std::move(all));
        });
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

using Graphs = std::shared_ptr<const std::vector<localization::PoseGraphView>>;

std::string_view kind_of(const localization::PoseGraphView& graph, const slam::Edge& edge) {
    if (edge.is_robust) return "loop";
    return graph.is_matched[edge.to] ? "match" : "odometry";
}

void append_keyframes(const std::string& robot, const localization::PoseGraphView& graph,
                      std::vector<std::string>& features) {
    for (std::size_t n = 0; n < graph.keyframes.size(); ++n) {
        const auto& pose = graph.keyframes[n];
        const boost::json::object properties{
            {"kind", "keyframe"}, {"robot", robot}, {"keyframe", n}, {"yaw", pose.yaw}};
        features.push_back(feature(properties, point_geometry({pose.x, pose.y})));
    }
}

void append_edges(const std::string& robot, const localization::PoseGraphView& graph,
                  std::vector<std::string>& features) {
    for (const auto& edge : graph.edges) {
        const Pose2& from = graph.keyframes[edge.from];
        const Pose2& to = graph.keyframes[edge.to];
        const Pose2 measured = compose(from, scan_matching::pose_of(edge.T_from_to));
        const boost::json::object properties{
            {"kind", kind_of(graph, edge)},
            {"robot", robot},
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
    const auto graphs = co_await read_poses<Graphs>(
        *session, [robots = snapshot->robots.size()](const localization::SessionPoses& poses) {
            std::vector<localization::PoseGraphView> all(robots);
            for (RobotIndex robot = 0; robot < robots; ++robot) all[robot] = poses.graph(robot);
            return std::make_shared<const std::vector<localization::PoseGraphView>>(std::move(all));
        });
    std::size_t parts = 0;
    for (const auto& graph : *graphs) parts += graph.keyframes.size() + graph.edges.size();
    auto permit = context.services.responses.take(parts * kEdgeTextBytes);
    if (!permit) co_return permit.error();
    std::vector<std::string> features;
    features.reserve(parts);
    for (std::size_t n = 0; n < graphs->size(); ++n) {
        append_keyframes(snapshot->robots[n].name, (*graphs)[n], features);
        append_edges(snapshot->robots[n].name, (*graphs)[n], features);
    }
    auto text = collection_document(snapshot->revision, {}, features);
    co_return ok_text("application/geo+json", std::move(*permit), std::move(text));
}

} // namespace scanloom::http
