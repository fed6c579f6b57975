#pragma once

#include "common/geometry/pose2.hpp"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace scanloom::landmarks {

struct Neighbor {
    std::size_t index = 0; ///< of the point among those the tree was made of
    double distance = 0.0; ///< metres

    friend bool operator==(const Neighbor&, const Neighbor&) = default;
};

/// Points of the plane, ordered so that those near a place are found without a look at the others (a KD-tree).
/// It keeps a copy of the points and never changes.
///
/// All answers are exact and come the nearest first, of equally near points the one with the lowest index. Distances
/// are compared by their squares, dx * dx + dy * dy in double precision.
///
/// Pre     points and places pass check_points().
/// Thread  any number at once.
/// Cost    n log n to make; log n + k for k answers, where few points are equal or equally near.
/// Source  Bentley, Multidimensional binary search trees (1975), as nanoflann has it.
class PointTree {
public:
    explicit PointTree(std::span<const Point2> points);
    PointTree(PointTree&& other) noexcept;
    PointTree& operator=(PointTree&& other) noexcept;
    ~PointTree();

    [[nodiscard]] std::size_t size() const noexcept;

    /// Nothing where there are no points.
    [[nodiscard]] std::optional<Neighbor> nearest(const Point2& place) const;

    /// The `count` nearest points, or all where there are fewer. A point at the place itself is one of them.
    [[nodiscard]] std::vector<Neighbor> nearest(const Point2& place, std::size_t count) const;

    /// All points at a distance of `radius` or less. Pre  radius >= 0; infinity: all points.
    [[nodiscard]] std::vector<Neighbor> within(const Point2& place, double radius) const;

private:
    struct Tree;
    std::unique_ptr<const Tree> tree_;
};

} // namespace scanloom::landmarks
