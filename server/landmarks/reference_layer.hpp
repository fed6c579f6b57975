#pragma once

#include "server/landmarks/session_captures.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

namespace scanloom::landmarks {

/// What was seen from one place, of what others can be found in.
struct ReferenceView {
    Point2 from{0.0, 0.0};       ///< metres, map frame
    std::vector<PointMm> points; ///< map frame
    Revision ended = 0;
};

/// Of a capture of many points, that stand for all.
[[nodiscard]] ReferenceView reference_view_of(const RobotCapture& capture);

/// By the log entry at which they ended.
using ReferenceViews = std::vector<std::shared_ptr<const ReferenceView>>;

/// Of a session's captures those that tell where what is now: of captures from one place and in one direction the
/// newest few, as doors open and people go. So their number grows with the ground that was covered, and not with time.
/// Thread  one writer; what snapshot() gives is for everybody.
class ReferenceLayer {
public:
    static constexpr double kPlaceSize = 0.5;           ///< metres, along each axis
    static constexpr int kDirections = 8;               ///< of a robot; a laser may see forward only
    static constexpr std::size_t kViewsOfAPlace = 2;    ///< in each direction
    static constexpr std::size_t kPointsOfAView = 4096; ///< of more points every so many-th stays

    /// The memory that a view takes beside its points while somebody is located, in points.
    static constexpr std::size_t kViewItself = 720;

    void add(const RobotCapture& ended);

    /// Points of all views that are kept, and kViewItself for each.
    [[nodiscard]] std::size_t size() const noexcept { return size_; }
    [[nodiscard]] ReferenceViews snapshot() const;

private:
    using PlaceKey = std::array<std::int64_t, 3>; // row, column, direction

    std::map<PlaceKey, ReferenceViews> places_; // each the oldest first
    std::size_t size_ = 0;
};

} // namespace scanloom::landmarks
