#pragma once

#include "core/scan_matching/point_map.hpp"
#include "core/slam/keyframe_graph.hpp"
#include "core/slam/keyframe_map.hpp"

#include <algorithm>
#include <cstddef>
#include <span>

namespace scanloom::slam {

/// How well points fit a map.
struct Evidence {
    static constexpr double kSquare = 0.25; ///< metres: callers add one point of each square of this side

    double matched = 0.0;      ///< metres of surface that agree with the map
    double contradicted = 0.0; ///< metres that contradict it: in seen free space, or behind a surface

    /// Returns the share of the metres that contradict the map, 0 to 1.
    [[nodiscard]] double share() const { return contradicted / std::max(1e-9, matched + contradicted); }

    /// Adds a point. It does not count where the map shows nothing.
    /// @param map    its space() is computed at the first use
    /// @param pose   of the robot, in the map's frame
    /// @param laser  metres, in the robot's frame
    /// @param point  that the laser saw, metres, in the robot's frame
    void add(KeyframeMap& map, const Transform2& pose, const Point2& laser, const scan_matching::SurfacePoint& point);
};

/// Returns by how much keyframes contradict each other: the share of contradictions of every second one to the map of
/// the others. People, glass, thin things and errors of poses cause them, also in a correct map.
/// @param graph      whose poses count
/// @param keyframes  in the order of their scans
/// @return 0 to 1
/// Cost: as a map of half of the keyframes with its seen space.
[[nodiscard]] double contradictions_between(const KeyframeGraph& graph, std::span<const std::size_t> keyframes);

} // namespace scanloom::slam
