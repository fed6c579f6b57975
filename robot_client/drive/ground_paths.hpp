#pragma once

#include "robot_client/drive/ground.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace scanloom::robot {

/// Finds the shortest path over the ground by steps to the 8 neighbouring cells without cutting corners, then leaves
/// out corners where the straight line fits. A robot that stands where the body does not fit starts at the nearest
/// fitting place within half a metre. The path begins at `from` and ends at `to`, in metres in the map frame.
/// @return nullopt if there is no path or the body does not fit at `to`
/// Source: Hart, Nilsson, Raphael, A Formal Basis for the Heuristic Determination of Minimum Cost Paths (1968).
[[nodiscard]] std::optional<std::vector<Point2>> find_path(const Ground& ground, const Point2& from, const Point2& to);

/// Returns the index of the target with the shortest path from a point, or nullopt if none can be reached.
[[nodiscard]] std::optional<std::size_t> nearest_by_path(const Ground& ground, const Point2& from,
                                                         std::span<const Point2> targets);

/// Returns the nearest cell to a point, by straight distance, where the body fits, within half a metre.
[[nodiscard]] std::optional<Spot> nearest_fitting(const Ground& ground, const Point2& point);

/// Returns for each of the ground's cells 1 if it can be reached from a point, else 0.
[[nodiscard]] std::vector<std::uint8_t> reachable_from(const Ground& ground, const Point2& point);

} // namespace scanloom::robot
