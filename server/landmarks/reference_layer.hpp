#pragma once

#include "server/landmarks/session_captures.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

namespace scanloom::landmarks {

/// What was seen from one place, for localization.
struct ReferenceView {
    Point2 from{0.0, 0.0};       ///< metres, map frame
    std::vector<PointMm> points; ///< map frame
    Revision ended = 0;
};

/// Converts a keyframe to a view. Of more than kPointsOfAView points, evenly chosen ones are kept.
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

    void add(const RobotCapture& ended);

    /// Returns the number of points of all views kept, plus kViewItself for each view.
    [[nodiscard]] std::size_t size() const noexcept { return size_; }
    [[nodiscard]] ReferenceViews snapshot() const;

private:
    using PlaceKey = std::array<std::int64_t, 3>; // row, column, direction

    std::map<PlaceKey, ReferenceViews> places_; // in each place the oldest view first
    std::size_t size_ = 0;
};

} // namespace scanloom::landmarks
