#pragma once

#include "robot_client/drive/ground.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace scanloom::robot {

/// The shortest way over the ground by steps to the 8 cells around, no corner cut, then with corners left out wherever
/// the straight way fits. A robot that stands where the body does not fit begins at the nearest place within half a
/// metre where it does; the way begins at `from` and ends at `to`, in metres of the map frame.
/// @return nothing where there is no way, or `to` does not fit.
/// Source  Hart, Nilsson, Raphael, A Formal Basis for the Heuristic Determination of Minimum Cost Paths (1968).
[[nodiscard]] std::optional<std::vector<Point2>> find_way(const Ground& ground, const Point2& from, const Point2& to);

/// The place of the target that has the shortest way from a point; nothing where none can be reached.
[[nodiscard]] std::optional<std::size_t> nearest_by_way(const Ground& ground, const Point2& from,
                                                        std::span<const Point2> targets);

/// The nearest place to a point, as the crow flies, where the body fits, within half a metre.
[[nodiscard]] std::optional<Spot> nearest_fitting(const Ground& ground, const Point2& point);

/// Which cells can be got to from a point, as the ground's cells, 0 or 1.
[[nodiscard]] std::vector<std::uint8_t> reachable_from(const Ground& ground, const Point2& point);

} // namespace scanloom::robot
