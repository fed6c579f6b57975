#pragma once

#include "core/slam/keyframe_graph.hpp"
#include "core/slam/keyframe_map.hpp"

#include <cstddef>
#include <vector>

namespace scanloom::slam {

/// A map of kSubmapLength successive keyframes of a fragment, in the frame of the middle one, its anchor. It does not
/// change when keyframes move, because the error of their relative poses within a submap is negligible.
/// Source: Hess, Kohler, Rapp, Andor, Real-Time Loop Closure in 2D LIDAR SLAM (2016), there of grids.
struct Submap {
    std::size_t fragment = 0; ///< of its keyframes
    std::size_t last = 0;     ///< position of its last keyframe in the fragment
    std::size_t anchor = 0;   ///< index of the keyframe whose frame it uses
    KeyframeMap map;          ///< in the anchor's frame
};

inline constexpr std::size_t kSubmapLength = 12; ///< keyframes
inline constexpr std::size_t kSubmapStep = 5;    ///< keyframes from the start of a submap to that of the next one

/// The submaps of all fragments.
/// Threads: one at a time.
class Submaps {
public:
    /// Adds the submaps that the newest keyframes of a fragment complete.
    void extend(const KeyframeGraph& graph, std::size_t fragment) {
        if (counts_.size() <= fragment) counts_.resize(fragment + 1);
        const auto& keyframes = graph.fragments()[fragment].keyframes;
        for (std::size_t& count = counts_[fragment];; ++count) {
            const std::size_t first = count * kSubmapStep;
            const std::size_t last = first + kSubmapLength - 1;
            if (last >= keyframes.size()) return;
            const std::size_t anchor = keyframes[(first + last) / 2];
            submaps_.push_back({fragment, last, anchor, KeyframeMap(graph.views_around(anchor, first, last))});
        }
    }

    /// Returns the number of submaps.
    [[nodiscard]] std::size_t size() const noexcept { return submaps_.size(); }
    /// Returns a submap, in the order in which they were completed. Precondition: index < size().
    [[nodiscard]] Submap& operator[](std::size_t index) { return submaps_[index]; }
    /// @copydoc operator[]
    [[nodiscard]] const Submap& operator[](std::size_t index) const { return submaps_[index]; }

    /// Lists the members that decide later results; see common/archive.
    template <class Self, class Archive>
    static void list(Self& self, Archive& archive) {
        archive(self.submaps_, self.counts_);
    }

    /// Returns whether the members fit together, as they always do unless they were read from damaged bytes.
    [[nodiscard]] bool is_consistent(const KeyframeGraph& graph) const;

private:
    std::vector<Submap> submaps_;
    std::vector<std::size_t> counts_; // of submaps, by fragment
};

} // namespace scanloom::slam
