#pragma once

#include "core/landmarks/landmark_map.hpp"
#include "core/localization/session_poses.hpp"
#include "server/foxglove/session_view.hpp"

#include <span>
#include <string>

/// Parts of a session as Message::kScene, in the map frame. Each is one entity, which replaces the one before.
namespace scanloom::foxglove {

/// Returns the landmarks as spheres.
/// @param stamp  seconds
[[nodiscard]] std::string landmarks_message(const landmarks::LandmarkView& landmarks, double stamp);

/// Returns the goals of robots as spheres with the robots' names.
/// @param stamp  seconds
[[nodiscard]] std::string goals_message(const SessionView& session, double stamp);

/// Returns the edges between located keyframes as lines: those along the way, those that close loops, and those that
/// are switched off, each in its colour.
/// @param stamp  seconds
[[nodiscard]] std::string pose_graph_message(const localization::PoseGraphView& graph, double stamp);

} // namespace scanloom::foxglove
