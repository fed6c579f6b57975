#pragma once

#include "common/geometry/pose2.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace scanloom::landmarks {

/// An index of points by the squares of a grid that contain them.
class CellIndex {
public:
    /// A square that contains points.
    struct Cell {
        std::int64_t j = 0;      ///< row
        std::int64_t i = 0;      ///< column
        std::uint32_t begin = 0; ///< index in order() of its first point
        std::uint32_t end = 0;   ///< the cell's points are order()[begin .. end)
    };

    static constexpr std::int64_t kReach = 2; ///< squares, along each axis

    /// Creates an index for neighbour searches. Any two points of one square are within `radius` of each other, and
    /// points within `radius` of a point are at most kReach squares away.
    /// @param points  metres
    /// @param radius  metres
    /// Precondition: the points pass check_points(); radius >= 1e-6.
    /// Cost: O(n log n).
    [[nodiscard]] static CellIndex of_radius(std::span<const Point2> points, double radius);

    /// Creates an index with squares of a given side, in metres.
    /// @param points  metres
    /// @param side    metres
    /// Precondition: the points pass check_points(); side >= 1e-6.
    /// Cost: O(n log n).
    [[nodiscard]] static CellIndex of_side(std::span<const Point2> points, double side) { return {points, side}; }

    /// Returns the points' indices ordered by cells, ascending within each cell.
    [[nodiscard]] const std::vector<std::uint32_t>& order() const noexcept { return order_; }
    /// Returns the cells that contain points, by rows.
    [[nodiscard]] const std::vector<Cell>& cells() const noexcept { return cells_; }
    /// Returns the indices of the points in a cell, ascending.
    [[nodiscard]] std::span<const std::uint32_t> points_of(const Cell& cell) const {
        return std::span(order_).subspan(cell.begin, cell.end - cell.begin);
    }

    /// Calls `visit` with the index of each cell around a cell, without the cell itself, in the order of cells(), until
    /// `visit` returns false.
    /// @param cell   index in cells()
    /// @param visit  receives indices in cells()
    template <class Visit>
    void around(std::size_t cell, Visit visit) const {
        for (std::int64_t row = -kReach; row <= kReach; ++row) {
            const std::int64_t j = cells_[cell].j + row;
            const std::int64_t last = cells_[cell].i + kReach;
            for (std::size_t other = first_from(j, cells_[cell].i - kReach);
                 other < cells_.size() && cells_[other].j == j && cells_[other].i <= last; ++other) {
                if (other != cell && !visit(other)) return;
            }
        }
    }

private:
    CellIndex(std::span<const Point2> points, double side);

    /// Returns the index of the first cell that is not before (j, i).
    [[nodiscard]] std::size_t first_from(std::int64_t j, std::int64_t i) const;

    std::vector<std::uint32_t> order_;
    std::vector<Cell> cells_;
};

/// A point that a search found.
struct Neighbor {
    std::size_t index = 0; ///< index of the point in the tree's input
    double distance = 0.0; ///< metres

    friend bool operator==(const Neighbor&, const Neighbor&) = default;
};

/// A KD-tree of points in the plane. It keeps a copy of the points and never changes.
///
/// All results are exact and ordered by distance, of equal distances by index. Distances are compared by their squares,
/// dx * dx + dy * dy in double precision.
/// Precondition: points and places pass check_points().
/// Threads: any number at the same time.
/// Cost: O(n log n) to build; O(log n + k) for k results if few points are equal or equally near.
/// Source: Bentley, Multidimensional binary search trees (1975), implemented by nanoflann.
class PointTree {
public:
    /// Builds the tree.
    /// @param points  metres; copied
    explicit PointTree(std::span<const Point2> points);
    /// Takes the contents of another tree, which may then only be assigned to or destroyed.
    PointTree(PointTree&& other) noexcept;
    /// Takes the contents of another tree, which may then only be assigned to or destroyed.
    PointTree& operator=(PointTree&& other) noexcept;
    ~PointTree();

    /// Returns the number of points.
    [[nodiscard]] std::size_t size() const noexcept;

    /// Returns the nearest point, or nullopt if the tree is empty.
    /// @param place  metres
    [[nodiscard]] std::optional<Neighbor> nearest(const Point2& place) const;

    /// Returns the nearest point, or nullopt if it is farther than `radius` away; faster than nearest().
    /// @param place   metres
    /// @param radius  metres, 0 or more
    [[nodiscard]] std::optional<Neighbor> nearest_within(const Point2& place, double radius) const;

    /// Returns the `count` nearest points, or all if there are fewer. A point at the place itself is included.
    /// @param place  metres
    /// @param count  largest number of results
    [[nodiscard]] std::vector<Neighbor> nearest(const Point2& place, std::size_t count) const;

    /// Returns all points at a distance of at most `radius` metres.
    /// @param place   metres
    /// @param radius  metres
    /// Precondition: radius >= 0; infinity returns all points.
    [[nodiscard]] std::vector<Neighbor> within(const Point2& place, double radius) const;

private:
    struct Tree;
    std::unique_ptr<const Tree> tree_;
};

} // namespace scanloom::landmarks
