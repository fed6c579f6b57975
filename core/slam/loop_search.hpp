#pragma once

#include "core/slam/keyframe_graph.hpp"
#include "core/slam/stretch_test.hpp"
#include "core/slam/submap.hpp"

#include <array>
#include <cstddef>
#include <deque>
#include <vector>

namespace scanloom::slam {

/// What a loop search has done since the object was made or read.
struct LoopFigures {
    /// Metres: bounds of `jumps`; the last count is of those beyond.
    static constexpr std::array<double, 6> kJumpBounds{0.05, 0.1, 0.3, 1.0, 3.0, 10.0};

    std::size_t matches = 0;            ///< of keyframes with submaps
    std::size_t disagreeing = 0;        ///< of these, refused: too few points match, or some are in seen free space
    std::size_t undetermined = 0;       ///< of these, refused: they do not determine the position
    std::size_t loops = 0;              ///< edges added for single matches
    std::size_t stretch_tests = 0;      ///< of large corrections
    std::size_t stretches_accepted = 0; ///< of these
    double jump_sum = 0.0;              ///< metres, of `jumps`
    std::array<std::size_t, kJumpBounds.size() + 1> jumps{}; ///< accepted corrections, by their size
};

/// Finds places where the robot was before, adds edges to them, and optimises the graph. Small corrections are accepted
/// from one match of a keyframe with a submap; large ones need a whole stretch of the trajectory that agrees
/// (accept_stretch()).
/// Source: as for Submap; the rules of acceptance are own.
/// Threads: one at a time.
class LoopSearch {
public:
    /// Searches for places around the newest keyframe of a fragment.
    /// @param graph     receives edges; its poses may move
    /// @param fragment  index of a fragment. While it is not located, only its own places are known
    /// Cost: at every second keyframe, time in proportion to the number of keyframes, and up to three scan matches.
    void search(KeyframeGraph& graph, std::size_t fragment);

    /// Adds the submaps that the newest keyframes of a fragment complete. search() does so for its fragment.
    void add_submaps(const KeyframeGraph& graph, std::size_t fragment) { submaps_.extend(graph, fragment); }

    /// Returns what the search has done, for reports.
    [[nodiscard]] const LoopFigures& figures() const noexcept { return figures_; }
    /// Returns how often the graph was optimised.
    [[nodiscard]] std::size_t optimization_count() const noexcept { return optimizations_; }

    /// Lists the members that decide later results; see common/archive.
    template <class Self, class Archive>
    static void list(Self& self, Archive& archive) {
        archive(self.submaps_, self.optimizations_, self.new_loops_, self.next_test_at_);
    }

    /// Returns whether the members fit together, as they always do unless they were read from damaged bytes.
    [[nodiscard]] bool is_consistent(const KeyframeGraph& graph) const { return submaps_.is_consistent(graph); }

private:
    /// A submap near the keyframe.
    struct NearbySubmap {
        std::size_t submap = 0;
        double distance = 0.0; // metres, from its anchor
        double drift = 0.0;    // metres, bound of the error of the keyframe's pose relative to it
    };

    /// What a match of the keyframe with a submap says.
    struct SubmapMatch {
        Transform2 T_anchor_keyframe;
        double jump = 0.0; // metres between the estimate and the match
        double turn = 0.0; // radians, likewise
        bool agrees = false;
        bool is_determined = false; // whether the scan determines the position in every direction
    };

    [[nodiscard]] std::vector<NearbySubmap> nearest_submaps(const KeyframeGraph& graph, std::size_t keyframe) const;
    [[nodiscard]] SubmapMatch match(const KeyframeGraph& graph, std::size_t keyframe, const NearbySubmap& near);
    [[nodiscard]] bool is_large(const NearbySubmap& near, const SubmapMatch& match) const;
    [[nodiscard]] bool try_stretch(KeyframeGraph& graph, std::size_t keyframe, const NearbySubmap& near,
                                   const SubmapMatch& match);
    void note_use(std::size_t submap);
    void note_jump(double metres);

    Submaps submaps_;
    std::deque<std::size_t> used_; // submaps whose maps are in memory, the oldest first
    LoopFigures figures_;
    std::size_t optimizations_ = 0;
    std::size_t new_loops_ = 0;        // since the last optimisation
    std::vector<double> next_test_at_; // by fragment, metres travelled: no stretch test before
};

} // namespace scanloom::slam
