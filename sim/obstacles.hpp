#pragma once

#include "sim/bucket_grid.hpp"

#include <span>

namespace scanloom::robot {

/// The static obstacles of a world, indexed so that few of them need to be checked to find the near ones. All results
/// equal those of checking every obstacle, bit for bit.
///
/// Threads: any thread; the object never changes.
class Obstacles {
public:
    Obstacles() = default;
    Obstacles(std::span<const Segment> outlines, std::span<const Box> solids) : outlines_(outlines), solids_(solids) {}

    /// Returns the distance in metres from `origin` along `yaw_rad` to the first outline. Beyond `range_max` the result
    /// may be infinite. Time: the buckets on the ray and the outlines in them.
    /// Source: Amanatides, Woo, A Fast Voxel Traversal Algorithm for Ray Tracing (1987).
    [[nodiscard]] double cast_ray(const Point2& origin, double yaw_rad, double range_max) const;

    /// Returns the distance in metres to the nearest outline; infinite if there is none.
    [[nodiscard]] double distance(const Point2& point) const;

    /// Returns whether the point is in a solid, borders included.
    [[nodiscard]] bool contain(const Point2& point) const;

    [[nodiscard]] const BucketGrid<Segment>& outlines() const noexcept { return outlines_; }

private:
    BucketGrid<Segment> outlines_;
    BucketGrid<Box> solids_;
};

} // namespace scanloom::robot
