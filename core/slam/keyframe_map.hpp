#pragma once

#include "core/scan_matching/point_map.hpp"
#include "core/scan_matching/seen_space.hpp"
#include "core/slam/keyframe.hpp"

#include <optional>
#include <utility>

namespace scanloom::slam {

/// The map of some keyframes: their points, and the space that they saw. The space is computed when it is first needed,
/// because most scans need only the points.
/// Threads: one at a time.
class KeyframeMap {
public:
    KeyframeMap() = default;

    /// Makes the map of these keyframes, in the frame of their poses.
    explicit KeyframeMap(KeyframeViews views) : views_(std::move(views)), points_(views_.views()) {}

    /// Returns the points of the map.
    [[nodiscard]] const scan_matching::PointMap& points() const noexcept { return points_; }

    /// Returns the space that the keyframes saw. The first call computes it.
    [[nodiscard]] const scan_matching::SeenSpace& space() {
        if (!space_) space_.emplace(views_.views());
        return *space_;
    }

    /// Frees the memory of space(), which computes it again when it is needed.
    void release_space() noexcept { space_.reset(); }

private:
    KeyframeViews views_;
    scan_matching::PointMap points_;
    std::optional<scan_matching::SeenSpace> space_;
};

} // namespace scanloom::slam
