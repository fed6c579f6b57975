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

/// Returns the frontiers of at least kFrontierCells cells as lines through their cells, the largest frontiers first, at
/// most kFrontierCellsShown cells.
/// @param stamp  seconds
/// Cost: that of classify::find_frontiers().
[[nodiscard]] std::string frontiers_message(const mapping::Snapshot& maps, double stamp);

inline constexpr std::size_t kFrontierCells = 8;
inline constexpr std::size_t kFrontierCellsShown = 20'000;

/// Returns the goals of robots as spheres with the robots' names.
/// @param stamp  seconds
[[nodiscard]] std::string goals_message(const SessionView& session, double stamp);

/// Returns the edges between located keyframes as lines: those along the way, those that close loops, and those that
/// are switched off, each in its colour. Edges of a known map, which no robot measured, are left out.
/// @param robots  number of robots in the session
/// @param stamp   seconds
[[nodiscard]] std::string pose_graph_message(const localization::PoseGraphView& graph, std::size_t robots,
                                             double stamp);

} // namespace scanloom::foxglove
