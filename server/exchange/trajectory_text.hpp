#pragma once

#include "core/localization/session_poses.hpp"

#include <cstddef>
#include <span>
#include <string>

/// Writes trajectories and pose graphs as text for programs that evaluate or optimise them. Metres and radians, in the
/// map frame.
namespace scanloom::exchange {

/// Approximate size of a pose's line in a trajectory, in bytes.
inline constexpr std::size_t kPoseTextBytes = 130;

/// Approximate size of an edge's line in a pose graph, with the line of a keyframe, in bytes.
inline constexpr std::size_t kEdgeTextBytes = 220;

/// Returns one line for each pose, in the TUM format: `stamp x y z qx qy qz qw`. z, qx and qy are 0.
/// Source: Sturm et al., A Benchmark for the Evaluation of RGB-D SLAM Systems (2012).
[[nodiscard]] std::string tum_text(std::span<const localization::StampedPose> poses);

/// Returns one line for each pose, in the KITTI format: the upper three rows of the matrix T_map_robot, row by row. It
/// has no stamps.
/// Source: Geiger, Lenz, Urtasun, Are we ready for Autonomous Driving? The KITTI Vision Benchmark Suite (2012).
[[nodiscard]] std::string kitti_text(std::span<const localization::StampedPose> poses);

/// Returns the located keyframes as VERTEX_SE2 lines, and the edges between them that count as EDGE_SE2 lines: nodes by
/// PoseGraphView::keyframes, the measured relative pose, and the upper triangle of its information (x, y, yaw).
/// Edges that are switched off are left out, because the format has no weights, and so are the parts of a map that no
/// scan of these robots shows: an imported one, or that of robots that send their poses.
/// @param robots  number of robots of the session
/// Source: Kuemmerle et al., g2o: A General Framework for Graph Optimization (2011).
[[nodiscard]] std::string g2o_text(const localization::PoseGraphView& graph, std::size_t robots);

} // namespace scanloom::exchange
