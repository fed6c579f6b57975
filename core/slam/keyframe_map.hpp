#pragma once

#include "core/scan_matching/point_map.hpp"
#include "core/scan_matching/seen_space.hpp"
#include "core/slam/keyframe.hpp"

#include <optional>
#include <utility>

namespace scanloom::slam {

/// The map of some keyframes: their points, and the space that they saw. Both are computed when they are first needed:
/// most scans need only the points, and of the maps that a checkpoint contains, most are not needed soon.
/// Threads: one at a time.
class KeyframeMap {
public:
    KeyframeMap() = default;

    /// Makes the map of these keyframes, in the frame of their poses.
    explicit KeyframeMap(KeyframeViews views) : views_(std::move(views)) {}

    /// Returns the points of the map. The first call computes them.
    [[nodiscard]] const scan_matching::PointMap& points() {
        if (!points_) points_.emplace(views_.views());
        return *points_;
    }

    /// Returns the space that the keyframes saw. The first call computes it.
    [[nodiscard]] const scan_matching::SeenSpace& space() {
        if (!space_) space_.emplace(views_.views());
        return *space_;
    }

    /// Frees the memory of points() and space(), which compute them again when they are needed.
    void release() noexcept {
        points_.reset();
        space_.reset();
    }

    /// Returns what the map consists of.
    [[nodiscard]] const KeyframeViews& views() const noexcept { return views_; }

    /// Lists the members that decide later results; see common/archive.
    template <class Self, class Archive>
    static void list(Self& self, Archive& archive) {
        archive(self.views_);
    }

private:
    KeyframeViews views_;
    std::optional<scan_matching::PointMap> points_;
    std::optional<scan_matching::SeenSpace> space_;
};

} // namespace scanloom::slam
