#pragma once

#include "core/slam/keyframe_graph.hpp"
#include "core/slam/stretch_test.hpp"
#include "core/slam/submap.hpp"

#include <cstddef>
#include <deque>
#include <vector>

namespace scanloom::slam {

/// Figures of a loop search, for reports.
struct LoopFigures {
    std::size_t matches = 0;            ///< of keyframes with submaps
    std::size_t loops = 0;              ///< edges added for single matches
    std::size_t stretch_tests = 0;      ///< of large corrections
    std::size_t stretches_accepted = 0; ///< of these
    std::size_t optimizations = 0;      ///< of the graph
};

/// Finds places where the robot was before, adds edges to them, and optimises the graph. Small corrections are accepted
/// from one match of a keyframe with a submap; large ones need a whole stretch of the trajectory that agrees
/// (accept_stretch()).
/// Threads: one at a time.
class LoopSearch {
public:
    /// Searches for places around the newest keyframe.
    /// @param graph  receives edges; its poses may move. Not empty
    /// Cost: at every second keyframe, time in proportion to the number of keyframes, and up to three scan matches.
    void search(KeyframeGraph& graph);

    /// Returns the figures since the start.
    [[nodiscard]] const LoopFigures& figures() const noexcept { return figures_; }

private:
    /// A submap near the newest keyframe.
    struct Place {
        std::size_t submap = 0;
        double distance = 0.0; // metres, from its anchor
        double drift = 0.0;    // metres, bound of the error of the keyframe's pose relative to it
    };

    /// What a match of the newest keyframe with a submap says.
    struct Answer {
        Transform2 T_anchor_newest;
        double jump = 0.0; // metres between the estimate and the match
        double turn = 0.0; // radians, likewise
        bool agrees = false;
        bool is_determined = false; // whether the scan determines the position in every direction
    };

    [[nodiscard]] std::vector<Place> nearest_places(const KeyframeGraph& graph) const;
    [[nodiscard]] Answer match(const KeyframeGraph& graph, const Place& place);
    [[nodiscard]] bool is_large(const Place& place, const Answer& answer) const;
    [[nodiscard]] bool try_stretch(KeyframeGraph& graph, const Place& place, const Answer& answer);
    void note_use(std::size_t submap);

    Submaps submaps_;
    std::deque<std::size_t> used_; // submaps whose seen space is in memory, the oldest first
    LoopFigures figures_;
    std::size_t new_loops_ = 0; // since the last optimisation
    double next_test_at_ = 0.0; // metres travelled: no stretch test before
};

} // namespace scanloom::slam
