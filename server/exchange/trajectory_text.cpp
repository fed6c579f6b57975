#include "server/exchange/trajectory_text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

namespace scanloom::exchange {

std::string tum_text(std::span<const localization::StampedPose> poses) {
    std::string text;
    text.reserve(poses.size() * kPoseTextBytes);
    for (const auto& [stamp, pose] : poses) {
        fmt::format_to(std::back_inserter(text), "{:.6f} {:.6f} {:.6f} 0 0 0 {:.9f} {:.9f}\n", stamp, pose.x, pose.y,
                       std::sin(pose.yaw / 2.0), std::cos(pose.yaw / 2.0));
    }
    return text;
}

std::string kitti_text(std::span<const localization::StampedPose> poses) {
    std::string text;
    text.reserve(poses.size() * kPoseTextBytes);
    for (const auto& [stamp, pose] : poses) {
        const double sine = std::sin(pose.yaw);
        const double cosine = std::cos(pose.yaw);
        fmt::format_to(std::back_inserter(text), "{:.9f} {:.9f} 0 {:.6f} {:.9f} {:.9f} 0 {:.6f} 0 0 1 0\n", cosine,
                       -sine, pose.x, sine, cosine, pose.y);
    }
    return text;
}

std::string g2o_text(const localization::PoseGraphView& graph, std::size_t robots) {
    const auto is_written = [&](std::size_t keyframe) {
        return graph.keyframes[keyframe].is_located && graph.keyframes[keyframe].robot < robots;
    };
    std::string text;
    text.reserve((graph.keyframes.size() + graph.edges.size()) * kEdgeTextBytes);
    for (std::size_t n = 0; n < graph.keyframes.size(); ++n) {
        if (!is_written(n)) continue;
        const Pose2& pose = graph.keyframes[n].pose;
        fmt::format_to(std::back_inserter(text), "VERTEX_SE2 {} {:.6f} {:.6f} {:.9f}\n", n, pose.x, pose.y, pose.yaw);
    }
    for (const auto& edge : graph.edges) {
        if (edge.weight < slam::kUsedWeight) continue;
        if (!is_written(edge.from) || !is_written(edge.to)) continue;
        const Pose2 measured = scan_matching::pose_of(edge.T_from_to);
        const auto& [xx, xy, xyaw, yy, yyaw, yawyaw] = edge.information;
        fmt::format_to(std::back_inserter(text),
                       "EDGE_SE2 {} {} {:.6f} {:.6f} {:.9f} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g}\n", edge.from,
                       edge.to, measured.x, measured.y, measured.yaw, xx, xy, xyaw, yy, yyaw, yawyaw);
    }
    return text;
}

} // namespace scanloom::exchange
