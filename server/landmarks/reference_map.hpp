#pragma once

#include "server/landmarks/alignment_candidates.hpp"
#include "server/landmarks/reference_layer.hpp"

#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace scanloom::landmarks {

using ReferenceViewSpan = std::span<const std::shared_ptr<const ReferenceView>>;

/// Of surfels_of(), for a map and what is laid on it: a wall is seen from many places, and where real poses are off by
/// centimetres a longer piece of it is no line.
inline constexpr double kAroundOfMap = 0.0;

/// How far what was seen reaches: a square, of which at least two opposite sides were seen.
struct Extent {
    Point2 middle{0.0, 0.0}; ///< metres, map frame
    double half = 0.0;       ///< metres from the middle to each side
};
/// None where nothing was seen.
[[nodiscard]] std::optional<Extent> extent_of(ReferenceViewSpan views);

/// What robots saw from many places as one surface, without what has gone since: what more of them looked through than
/// saw.
/// Frame   the map's, from middle(): so nothing is lost far from the origin.
/// Thread  any, once it is made.
class ReferenceMap {
public:
    /// @param middle  what its own frame's origin is to be, in the map frame
    /// @param ask     now and then; its error ends it
    /// Cost  n log n of the points, and of each surface element all views.
    [[nodiscard]] static Result<ReferenceMap> of(
        ReferenceViewSpan views, const Point2& middle,
        const std::function<Result<>()>& ask = [] { return Result<>(); });

    [[nodiscard]] bool is_empty() const noexcept { return surfels_.empty(); }
    [[nodiscard]] const Point2& middle() const noexcept { return middle_; } ///< metres, map frame
    [[nodiscard]] const std::vector<Surfel>& surfels() const noexcept { return surfels_; }

    /// What there is within `radius` metres of a place, and who looked at it. This must outlive it.
    [[nodiscard]] Seen around(const Point2& place, double radius) const;

    /// Whether a sensor may be there: somebody has looked at the place or through it, or been there. Not behind walls.
    [[nodiscard]] bool is_possible(const Point2& place) const;

private:
    explicit ReferenceMap(const Point2& middle) : middle_(middle) {}

    [[nodiscard]] bool has_gone(const Point2& place) const;

    Point2 middle_;
    std::vector<Horizon> horizons_;
    std::vector<Surfel> surfels_;
};

} // namespace scanloom::landmarks
