#pragma once

#include "common/geometry/pose2.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace scanloom::robot {

/// The free cells of a map, not counting what moves. Cell (0, 0) has its lower-left corner at the map's origin.
struct FloorPlan {
    double cell_size = 0.0;   ///< metres
    std::int32_t i_begin = 0; ///< of the lowest, leftmost cell
    std::int32_t j_begin = 0;
    std::int32_t width = 0; ///< cells
    std::int32_t height = 0;
    std::vector<std::uint8_t> is_free; ///< width * height of 0 or 1, bottom row first
};

/// A cell of a floor plan, counted from the plan's lower-left cell.
struct Spot {
    std::int32_t x = 0;
    std::int32_t y = 0;

    friend bool operator==(const Spot&, const Spot&) = default;
};

/// The cells of a floor plan where a body's centre may be: free cells whose centre is at least a clearance away from
/// every cell that is not free.
class Ground {
public:
    Ground(FloorPlan plan, double clearance_m);

    [[nodiscard]] const FloorPlan& plan() const noexcept { return plan_; }

    /// Returns a copy that also excludes the cells within `clearance_m` of any of the points.
    [[nodiscard]] Ground without(std::span<const Point2> obstacles, double clearance_m) const;

    [[nodiscard]] bool holds(Spot spot) const noexcept {
        return spot.x >= 0 && spot.y >= 0 && spot.x < plan_.width && spot.y < plan_.height;
    }
    [[nodiscard]] std::size_t index_of(Spot spot) const noexcept {
        return static_cast<std::size_t>(spot.y) * static_cast<std::size_t>(plan_.width) +
               static_cast<std::size_t>(spot.x);
    }
    /// Outside the plan no cell is free and the body fits nowhere.
    [[nodiscard]] bool is_free(Spot spot) const noexcept { return holds(spot) && plan_.is_free[index_of(spot)] != 0; }
    [[nodiscard]] bool fits(Spot spot) const noexcept { return holds(spot) && fits_[index_of(spot)] != 0; }

    [[nodiscard]] Spot spot_of(const Point2& point) const noexcept;
    [[nodiscard]] Point2 centre_of(Spot spot) const noexcept;

    /// Returns whether a body's centre can move straight from one point to another.
    [[nodiscard]] bool fits_along(const Point2& from, const Point2& to) const noexcept;

    /// Returns whether a point is within `metres` of a cell that is not free; true outside the plan.
    [[nodiscard]] bool is_near_solid(const Point2& point, double metres) const noexcept;

private:
    void take_out_around(Spot centre, double radius_m);

    FloorPlan plan_;
    std::vector<std::uint8_t> fits_; // as plan_.is_free
};

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
