#pragma once

#include "core/planning/passability.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace scanloom::sim {

using planning::BitGrid;
using planning::Spot;

/// The free cells of a map, not counting what moves.
struct FloorPlan {
    double cell_size = 0.0; ///< metres
    grid::CellBox window;   ///< the cells of the plan; cell (0, 0) has its lower-left corner at the map's origin
    BitGrid free;           ///< Spot (0, 0) is the lowest, leftmost cell; may be larger than the window

    /// Creates a plan without free cells.
    /// @param cell_size_m  metres
    FloorPlan(double cell_size_m, const grid::CellBox& cells);
};

/// The cells of a floor plan where a body's centre may be: free cells whose centre is at least a clearance away from
/// every cell of the plan that is not free.
class Ground {
public:
    Ground(const FloorPlan& plan, double clearance_m);

    /// Returns a copy that also excludes the cells within `clearance_m` of any of the points.
    [[nodiscard]] Ground without(std::span<const Point2> obstacles, double clearance_m) const;

    [[nodiscard]] double cell_size() const noexcept { return passability_.cell_size_m; } ///< metres
    [[nodiscard]] const BitGrid& free() const noexcept { return passability_.ground; }
    [[nodiscard]] const planning::Passability& passability() const noexcept { return passability_; }

    /// Outside the plan no cell is free and the body fits nowhere.
    [[nodiscard]] bool is_free(Spot spot) const noexcept { return holds(spot) && passability_.ground.test(spot); }
    [[nodiscard]] bool fits(Spot spot) const noexcept { return holds(spot) && passability_.enterable.test(spot); }

    /// Returns the cell that contains a point, also outside the plan.
    [[nodiscard]] Spot spot_of(const Point2& point) const noexcept;
    [[nodiscard]] Point2 centre_of(Spot spot) const noexcept { return passability_.centre_of(spot); }

    /// Returns whether a body's centre can move straight from one point to another.
    [[nodiscard]] bool fits_along(const Point2& from, const Point2& to) const;

    /// Returns whether a point is within `metres` of a cell that is not free; true outside the plan.
    [[nodiscard]] bool is_near_solid(const Point2& point, double metres) const noexcept;

private:
    [[nodiscard]] bool holds(Spot spot) const noexcept {
        return spot.x >= 0 && spot.y >= 0 && spot.x < free().width() && spot.y < free().height();
    }

    planning::Passability passability_;
};

/// Finds the shortest path over the ground (core/planning/grid_path.hpp). A robot that stands where the body does not
/// fit starts as planning::open_start() says. The path begins at `from` and ends at `to`, in metres in the map frame.
/// @return nullopt if there is no path or the body does not fit at `to`
[[nodiscard]] std::optional<std::vector<Point2>> find_path(const Ground& ground, const Point2& from, const Point2& to);

/// Returns the index of the target with the shortest path from a point, or nullopt if none can be reached.
[[nodiscard]] std::optional<std::size_t> nearest_by_path(const Ground& ground, const Point2& from,
                                                         std::span<const Point2> targets);

/// Returns the cells where the body fits and that it can reach from a point.
[[nodiscard]] BitGrid reachable_from(const Ground& ground, const Point2& point);

/// Measures which share of the reachable free cells a body has covered. A cell is covered or reachable if its centre is
/// within the body's radius of a position of the body.
class CoverageMeter {
public:
    CoverageMeter() = default;

    /// @param places  the cells where the body's centre may be
    CoverageMeter(const Ground& ground, const BitGrid& places);

    /// Covers the cells at a position of the body, in metres.
    void pass(const Ground& ground, const Point2& position);

    [[nodiscard]] double share() const noexcept; ///< 0 .. 1; 1 if no cell is reachable
    [[nodiscard]] double reachable_m2() const noexcept { return static_cast<double>(reachable_) * cell_m2_; }

private:
    BitGrid left_;               // reachable and not covered yet
    std::int64_t reachable_ = 0; // cells
    std::int64_t passed_ = 0;
    double cell_m2_ = 0.0;
};

} // namespace scanloom::sim
