#pragma once

#include "server/landmarks/alignment_candidates.hpp"
#include "server/landmarks/reference_layer.hpp"

#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace scanloom::landmarks {

using ReferenceViewSpan = std::span<const std::shared_ptr<const ReferenceView>>;

/// The parameter `around` of surfels_of() for a map and for views matched against it. A wall is seen from many places,
/// and where real poses are off by centimetres, a longer piece of it is no line.
inline constexpr double kAroundOfMap = 0.0;

/// The extent of all points: a square with points on at least two opposite sides.
struct Extent {
    Point2 middle{0.0, 0.0}; ///< metres, map frame
    double half = 0.0;       ///< metres from the middle to each side
};
/// Returns the extent of the views' points, or nullopt if there are none.
[[nodiscard]] std::optional<Extent> extent_of(ReferenceViewSpan views);

/// The surface that robots saw from many places, without what has gone since: elements that more views looked through
/// than saw.
///
/// Positions are relative to middle(), with the axes of the map frame, so that no precision is lost far from the
/// origin.
/// Threads: any thread after construction.
class ReferenceMap {
public:
    /// Builds the map of views.
    /// @param middle  origin of the map's own frame; metres, map frame
    /// @param ask     called for each view and each surface element; an error that it returns ends the construction
    /// Errors: those of `ask`.
    /// Cost: O(n log n) of the points, and the number of surface elements times the number of views.
    [[nodiscard]] static Result<ReferenceMap> of(
        ReferenceViewSpan views, const Point2& middle,
        const std::function<Result<>()>& ask = [] { return Result<>(); });

    [[nodiscard]] bool is_empty() const noexcept { return surfels_.empty(); }
    [[nodiscard]] const Point2& middle() const noexcept { return middle_; } ///< metres, map frame
    [[nodiscard]] const std::vector<Surfel>& surfels() const noexcept { return surfels_; }

    /// Returns the surface within `radius` metres of a place, and the horizons of the views that may show it. This
    /// object must outlive the result.
    [[nodiscard]] Seen around(const Point2& place, double radius) const;

    /// Returns whether a sensor can be at a place: a view looked at the place or through it, or was taken there. Places
    /// behind walls are excluded.
    [[nodiscard]] bool is_possible(const Point2& place) const;

private:
    explicit ReferenceMap(const Point2& middle) : middle_(middle) {}

    [[nodiscard]] bool has_gone(const Point2& place) const;

    Point2 middle_;
    std::vector<Horizon> horizons_;
    std::vector<Surfel> surfels_;
};

} // namespace scanloom::landmarks
