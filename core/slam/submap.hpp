#pragma once

#include "core/slam/keyframe_graph.hpp"
#include "core/slam/keyframe_map.hpp"

#include <cstddef>
#include <vector>

namespace scanloom::slam {

/// A map of kSubmapLength successive keyframes, in the frame of the middle one, its anchor. It does not change when
/// keyframes move, because the error of their relative poses within a submap is negligible.
struct Submap {
    std::size_t last = 0;   ///< index of its last keyframe
    std::size_t anchor = 0; ///< index of the keyframe whose frame it uses
    KeyframeMap map;        ///< in the anchor's frame
};

inline constexpr std::size_t kSubmapLength = 12; ///< keyframes
inline constexpr std::size_t kSubmapStep = 5;    ///< keyframes from the start of a submap to that of the next one

/// The submaps of a robot's keyframes.
/// Threads: one at a time.
class Submaps {
public:
    /// Adds the submaps that the newest keyframes complete.
    void extend(const KeyframeGraph& graph) {
        for (;;) {
            const std::size_t first = submaps_.size() * kSubmapStep;
            const std::size_t last = first + kSubmapLength - 1;
            if (last >= graph.size()) return;
            const std::size_t anchor = (first + last) / 2;
            submaps_.push_back({last, anchor, KeyframeMap(graph.views_around(first, last, anchor))});
        }
    }

    /// Returns the number of submaps.
    [[nodiscard]] std::size_t size() const noexcept { return submaps_.size(); }
    /// Returns a submap, by the order of its keyframes. Precondition: index < size().
    [[nodiscard]] Submap& operator[](std::size_t index) { return submaps_[index]; }
    /// @copydoc operator[]
    [[nodiscard]] const Submap& operator[](std::size_t index) const { return submaps_[index]; }

private:
    std::vector<Submap> submaps_;
};

} // namespace scanloom::slam
