#pragma once

#include "core/slam/keyframe_graph.hpp"

#include <cstddef>

namespace scanloom::slam {

/// A supposed correction of a keyframe, found by a match with an old submap.
struct StretchQuestion {
    std::size_t keyframe = 0;       ///< the newest one of its fragment
    std::size_t anchor = 0;         ///< the old submap's anchor keyframe
    Transform2 correction;          ///< T_corrected_map of the keyframe and the stretch before it; identity: the match
                                    ///< failed, and the question is only whether the trajectory should move at all
    double window = 0.0;            ///< metres: by how much the trajectory may have to move
    double contradicted_max = 0.33; ///< share of the evidence that may contradict an accepted correction
    double noise_factor = 0.0; ///< contradictions_between() the old map's keyframes, times this, may be in addition
};

/// Decides how the newest stretch of a fragment, up to 60 m, fits the map of the other keyframes. Several
/// hypotheses are followed backwards along the stretch: the supposed correction, none, and shifts that fit. The best
/// one is accepted only if it fits well over some metres and every other one is refuted by space that beams passed;
/// otherwise the answer is no, and a later keyframe may ask again.
///
/// After acceptance the graph has edges from the stretch to the old map, and no older loop edges into the stretch that
/// contradict them by over 0.5 m. Its poses do not move.
/// Source: own.
/// @param graph     keyframes and edges
/// @param question  the correction to test
/// @return whether one hypothesis was accepted. It may be that of no correction: then the new edges confirm the trajectory
/// Precondition: question.anchor shares a frame with the keyframe (KeyframeGraph::share_frame()), and is before it if both
///     are in one fragment; 0 <= window <= 8 m.
/// Cost: some hundredths of a second: up to 10 hypotheses, each with a scan match of 100 points every 1.5 m, and
///     (2 window / 0.2 m)^2 shifts.
[[nodiscard]] bool accept_stretch(KeyframeGraph& graph, const StretchQuestion& question);

} // namespace scanloom::slam
