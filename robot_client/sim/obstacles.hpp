#pragma once

#include "robot_client/sim/bucket_grid.hpp"

#include <span>

namespace scanloom::robot {

/// What stands still in a world, in an order in which little need be looked at to tell what is near. All answers are
/// those of looking at everything, bit for bit.
///
/// Thread  any; it never changes.
class Obstacles {
public:
    Obstacles() = default;
    Obstacles(std::span<const Segment> outlines, std::span<const Box> solids) : outlines_(outlines), solids_(solids) {}

    /// Metres from `origin` along `yaw_rad` to the first outline. What is farther than `range_max` may be left out:
    /// then it is infinite.
    /// Cost    the buckets on the ray and the outlines in them.
    /// Source  Amanatides, Woo: A fast voxel traversal algorithm for ray tracing (1987).
    [[nodiscard]] double cast_ray(const Point2& origin, double yaw_rad, double range_max) const;

    /// Metres to the nearest outline; infinite where there is none.
    [[nodiscard]] double distance(const Point2& point) const;

    /// Whether a solid stands here, borders included.
    [[nodiscard]] bool contain(const Point2& point) const;

    [[nodiscard]] const BucketGrid<Segment>& outlines() const noexcept { return outlines_; }

private:
    BucketGrid<Segment> outlines_;
    BucketGrid<Box> solids_;
};

} // namespace scanloom::robot
