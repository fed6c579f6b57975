#pragma once

#include "common/scan/limits.hpp"
#include "core/scan_matching/point_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace scanloom::slam {

using scan_matching::ScanPoints;
using scan_matching::Transform2;

/// A selected scan. Maps consist of keyframes, and every other scan's pose is stored relative to one.
struct Keyframe {
    std::shared_ptr<const ScanPoints> scan; ///< its points
    std::size_t fragment = 0;               ///< that it belongs to
    std::size_t position = 0;               ///< among the keyframes of the fragment
    bool is_fixed = false;                  ///< whether it belongs to a map that does not change
    double travelled = 0.0; ///< metres from the fragment's first keyframe; a turn of one radian counts as 0.2 m
};

/// Returns whether a pose is farther from a keyframe than a distance (metres) or a turn (radians).
[[nodiscard]] inline bool is_beyond(const Transform2& T_keyframe_robot, double distance, double turn) {
    const Transform2& T = T_keyframe_robot;
    return T.x * T.x + T.y * T.y > distance * distance || std::fabs(yaw_of(T)) > turn;
}

inline constexpr double kKeyframeDistance = 0.8; ///< metres from a keyframe to the robot's next one
inline constexpr double kKeyframeTurn = 0.4;     ///< radians, likewise

/// Returns whether the position of a pose is within a distance (metres) of a place. False for NaN.
[[nodiscard]] inline bool is_near(const Transform2& T_map_robot, const Point2& place, double distance) noexcept {
    const double x = T_map_robot.x - place.x;
    const double y = T_map_robot.y - place.y;
    return x * x + y * y <= distance * distance;
}

/// Metres from the origin of a fragment's frame to its robot: one that seems to be farther away is lost, and begins
/// another fragment. The poses that robots send, and where fragments begin, are nearer.
inline constexpr double kEstimateMax = 2.0 * kCoordinateMax;

/// Metres from the map's origin to any pose: a fragment whose newest keyframe is located reaches twice as far as
/// kEstimateMax from there.
inline constexpr double kPoseMax = 4.0 * kEstimateMax;

/// Metres from the center of a map to its keyframes, at most: the memory of a map is in proportion to the rectangle
/// around it, and poses that robots send can be far from each other. What is farther away shows nothing of the center.
inline constexpr double kMapRadius = 100.0;

/// Keyframes with their poses in the frame of one map, around its center. Keeps the scans alive that the views refer
/// to.
class KeyframeViews {
public:
    /// @param center  metres, in the frame of the map: where scans are to be matched to it
    /// @param radius  metres: keyframes that are farther from the center are left out
    explicit KeyframeViews(const Point2& center = {0.0, 0.0}, double radius = kMapRadius)
        : center_(center), radius_(radius) {}

    /// Adds a keyframe, unless it is too far from the center.
    /// @param keyframe        its scan
    /// @param T_map_keyframe  its pose in the frame of the map
    void add(const Keyframe& keyframe, const Transform2& T_map_keyframe) {
        if (!is_near(T_map_keyframe, center_, radius_)) return;
        scans_.push_back(keyframe.scan);
        views_.push_back({T_map_keyframe, scans_.back()->points, scans_.back()->laser});
    }

    /// Returns the views. Valid while this object exists and add() is not called.
    [[nodiscard]] std::span<const scan_matching::View> views() const noexcept { return views_; }

    /// Returns whether the views are as near to each other as those around a center within kMapRadius, and their points
    /// in the reach of lasers, as they always are unless they were read from damaged bytes.
    [[nodiscard]] bool is_consistent() const {
        return std::ranges::all_of(scans_, [](const auto& scan) { return scan_matching::are_in_reach(*scan); }) &&
               std::ranges::all_of(views_, [&](const scan_matching::View& view) {
                   const Transform2& first = views_.front().T_map_robot;
                   return is_near(view.T_map_robot, {first.x, first.y}, 2.0 * kMapRadius);
               });
    }

    /// Lists the members that decide later results; see common/archive.
    template <class Self, class Archive>
    static void list(Self& self, Archive& archive) {
        archive(self.scans_);
        if constexpr (Archive::kReads) {
            self.views_.clear();
            if (archive.failed()) return; // some scans may be null
            for (const auto& scan : self.scans_) self.views_.push_back({{}, scan->points, scan->laser});
        }
        for (auto& view : self.views_) archive(view.T_map_robot);
    }

private:
    Point2 center_; // only needed until the last add()
    double radius_;
    std::vector<std::shared_ptr<const ScanPoints>> scans_; // what views_ refer to
    std::vector<scan_matching::View> views_;
};

} // namespace scanloom::slam
