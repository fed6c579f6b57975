#pragma once

#include "common/geometry/pose2.hpp"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace scanloom::landmarks {

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
    explicit PointTree(std::span<const Point2> points);
    PointTree(PointTree&& other) noexcept;
    PointTree& operator=(PointTree&& other) noexcept;
    ~PointTree();

    [[nodiscard]] std::size_t size() const noexcept;

    /// Returns the nearest point, or nullopt if the tree is empty.
    [[nodiscard]] std::optional<Neighbor> nearest(const Point2& place) const;

    /// Returns the `count` nearest points, or all if there are fewer. A point at the place itself is included.
    [[nodiscard]] std::vector<Neighbor> nearest(const Point2& place, std::size_t count) const;

    /// Returns all points at a distance of at most `radius` metres.
    /// Precondition: radius >= 0; infinity returns all points.
    [[nodiscard]] std::vector<Neighbor> within(const Point2& place, double radius) const;

private:
    struct Tree;
    std::unique_ptr<const Tree> tree_;
};

} // namespace scanloom::landmarks
