#pragma once

#include "server/landmarks/alignment_candidates.hpp"
#include "server/landmarks/reference_layer.hpp"

#include <span>
#include <vector>

namespace scanloom::landmarks {

/// What robots saw from many places as one surface, without what has gone since: what more of them looked through than
/// saw.
/// Frame   the map's, from middle(): so nothing is lost far from the origin.
/// Thread  any, once it is made.
class ReferenceMap {
public:
    /// Cost  n log n of the points, and of each surface element the views around.
    explicit ReferenceMap(std::span<const std::shared_ptr<const ReferenceView>> views);

    [[nodiscard]] bool is_empty() const noexcept { return surfels_.empty(); }
    [[nodiscard]] const Point2& middle() const noexcept { return middle_; } ///< metres, map frame
    /// Metres from the middle to the furthest surface, along either axis.
    [[nodiscard]] double half_extent() const noexcept { return half_extent_; }
    [[nodiscard]] const std::vector<Surfel>& surfels() const noexcept { return surfels_; }

    /// What there is within `radius` metres of a place, and who looked at it. This must outlive it.
    [[nodiscard]] Seen around(const Point2& place, double radius) const;

    /// Whether a sensor may be there: somebody has looked at the place or through it, or been there. Not behind walls.
    [[nodiscard]] bool is_possible(const Point2& place) const;

private:
    [[nodiscard]] bool has_gone(const Point2& place) const;

    Point2 middle_{0.0, 0.0};
    double half_extent_ = 0.0;
    std::vector<Horizon> horizons_;
    std::vector<Surfel> surfels_;
};

} // namespace scanloom::landmarks
