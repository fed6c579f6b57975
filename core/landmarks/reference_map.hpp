#pragma once

#include "core/landmarks/alignment_hypotheses.hpp"
#include "core/landmarks/captures.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace scanloom::landmarks {

/// What was seen from one place, for localization.
struct ReferenceView {
    Point2 from{0.0, 0.0};       ///< metres, map frame
    std::vector<PointMm> points; ///< map frame
    Revision ended = 0;          ///< log entry at which the keyframe ended
};

/// Converts a keyframe to a view. Of more than kPointsOfAView points, evenly chosen ones are kept.
/// @param capture  points in millimetres of the map frame
[[nodiscard]] ReferenceView reference_view_of(const RobotCapture& capture);

/// Views, ordered by the log entry at which they ended.
using ReferenceViews = std::vector<std::shared_ptr<const ReferenceView>>;

/// The keyframes of a session that are used for localization: the newest few of each place and direction, because doors
/// open and people leave. So their number grows with the area that was covered, and not with time.
/// Threads: one writer; any thread may use what snapshot() returned.
class ReferenceLayer {
public:
    static constexpr double kPlaceSize = 0.5;           ///< metres, along each axis
    static constexpr int kDirections = 8;               ///< headings of a robot; a laser may only see forward
    static constexpr std::size_t kViewsOfAPlace = 2;    ///< for each direction
    static constexpr std::size_t kPointsOfAView = 4096; ///< of more points, every n-th is kept

    /// The memory that a view needs in addition to its points during localization, in points.
    static constexpr std::size_t kViewItself = 720;

    /// Adds a keyframe. It replaces the oldest one of the same place and direction if there are kViewsOfAPlace already.
    /// @param ended  a keyframe of SessionCaptures; they are added in the order in which they end
    void add(const RobotCapture& ended);

    /// Returns the number of points of all views kept, plus kViewItself for each view.
    [[nodiscard]] std::size_t size() const noexcept { return size_; }
    /// Returns the keyframes that are kept now.
    [[nodiscard]] ReferenceViews snapshot() const;

private:
    using PlaceKey = std::array<std::int64_t, 3>; // row, column, direction

    std::map<PlaceKey, ReferenceViews> places_; // in each place the oldest view first
    std::size_t size_ = 0;
};

/// Some of the views, ordered as in ReferenceViews.
using ReferenceViewSpan = std::span<const std::shared_ptr<const ReferenceView>>;

/// The extent of all points: a square with points on at least two opposite sides.
struct Extent {
    Point2 middle{0.0, 0.0}; ///< metres, map frame
    double half = 0.0;       ///< metres from the middle to each side
};
/// Returns the extent of the views' points, or nullopt if there are none.
/// @param views  points in millimetres of the map frame
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
    /// @param views   points in millimetres of the map frame
    /// @param middle  origin of the map's own frame; metres, map frame
    /// @param ask     called for each view and each surface element; an error that it returns ends the construction
    /// Errors: those of `ask`.
    /// Cost: O(n log n) of the points, and the number of surface elements times the number of views.
    [[nodiscard]] static Result<ReferenceMap> of(
        ReferenceViewSpan views, const Point2& middle,
        const std::function<Result<>()>& ask = [] { return Result<>(); });

    /// Returns whether the map has no surface elements.
    [[nodiscard]] bool is_empty() const noexcept { return surfels_.empty(); }
    [[nodiscard]] const Point2& middle() const noexcept { return middle_; } ///< metres, map frame
    /// Returns the surface elements, metres, relative to middle().
    [[nodiscard]] const std::vector<Surfel>& surfels() const noexcept { return surfels_; }

    /// Returns the surface within `radius` metres of a place, and the horizons of the views that may show it. This
    /// object must outlive the result.
    /// @param place   metres, relative to middle()
    /// @param radius  metres
    [[nodiscard]] Seen around(const Point2& place, double radius) const;

    /// Returns whether a sensor can be at a place: a view looked at the place or through it, or was taken there. Places
    /// behind walls are excluded.
    /// @param place  metres, relative to middle()
    [[nodiscard]] bool is_possible(const Point2& place) const;

private:
    explicit ReferenceMap(const Point2& middle) : middle_(middle) {}

    [[nodiscard]] bool has_gone(const Point2& place) const;

    Point2 middle_;
    std::vector<Horizon> horizons_;
    std::vector<Surfel> surfels_;
};

} // namespace scanloom::landmarks
