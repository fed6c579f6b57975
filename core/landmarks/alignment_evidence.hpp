#pragma once

#include "core/landmarks/refinement.hpp"

#include <array>
#include <cstddef>
#include <span>

namespace scanloom::landmarks {

/// How far a sensor could see from one place in each direction, according to the points that it saw there.
class Horizon {
public:
    /// @param points  metres
    /// @param from    the position of the sensor, in the frame of the points
    Horizon(std::span<const Point2> points, const Point2& from);

    /// What the sensor saw at a place.
    enum class Verdict {
        kOpen,    ///< free space: the points in this direction are further away
        kHidden,  ///< behind the points in this direction
        kUnknown, ///< about as far as the points in this direction, or there are none
    };
    /// Returns what the sensor saw at a place.
    /// @param place  metres, in the frame of the points
    [[nodiscard]] Verdict at(const Point2& place) const;
    /// Returns the position of the sensor, metres, in the frame of the points.
    [[nodiscard]] const Point2& from() const noexcept { return from_; }
    [[nodiscard]] double reach() const noexcept { return reach_; } ///< metres, distance of the furthest point
    /// Returns whether any point in any direction is further away than the place. at() returns kOpen for no other
    /// places; this check is faster.
    /// @param place  metres, in the frame of the points
    [[nodiscard]] bool reaches(const Point2& place) const { return squared_norm(place - from_) < reach_ * reach_; }

private:
    static constexpr std::size_t kSectors = 360;

    struct Reach {
        double nearest;
        double furthest;
    };
    [[nodiscard]] static std::size_t sector_of(const Point2& offset);

    Point2 from_;
    double reach_ = 0.0;
    std::array<Reach, kSectors> reaches_;
};

/// How many surface elements of one view support or contradict a pose, as seen by another view.
struct Evidence {
    std::size_t inliers = 0;  ///< lie on the other view's surface
    std::size_t outliers = 0; ///< lie in the free space of the other view
    std::size_t elements = 0; ///< all; those neither inliers nor outliers were not visible to the other view

    /// Returns the sums of the counts.
    friend Evidence operator+(const Evidence& a, const Evidence& b) {
        return {a.inliers + b.inliers, a.outliers + b.outliers, a.elements + b.elements};
    }
};

/// Tests the surface elements of a second view, in a given pose, against what a first view shows. An element is an
/// outlier if it is not on the first view's surface and any of the horizons looked through its position.
/// @param surface         of the first view, in the first frame
/// @param horizons        of the places that the first view was seen from
/// @param second          surface elements of the second view, in the second frame
/// @param T_first_second  pose of the second frame in the first frame
/// Precondition: the surface has elements.
[[nodiscard]] Evidence evidence_of(const Surface& surface, std::span<const Horizon* const> horizons,
                                   std::span<const Surfel> second, const Pose2& T_first_second);

} // namespace scanloom::landmarks
