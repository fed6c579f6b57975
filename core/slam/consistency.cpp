#include "core/slam/trajectory_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

/// Whether members that were read fit together. Bytes can be damaged, or of another program, and still have correct
/// checksums; then no index may be beyond its end, and no map too large for the memory. What estimators
/// produce is accepted: the limits are those by which they are made.
namespace scanloom::slam {
namespace {

bool is_possible(const Transform2& T_map_robot) { return is_near(T_map_robot, {0.0, 0.0}, kPoseMax); }

bool is_finite(const Information& information) {
    const auto& [xx, xy, xyaw, yy, yyaw, yawyaw] = information;
    return std::isfinite(xx + xy + xyaw + yy + yyaw + yawyaw);
}

} // namespace

bool KeyframeGraph::is_consistent() const {
    std::size_t count = 0;
    for (std::size_t f = 0; f < fragments_.size(); ++f) {
        const auto& keyframes = fragments_[f].keyframes;
        if (keyframes.empty()) return false;
        for (std::size_t n = 0; n < keyframes.size(); ++n) {
            if (keyframes[n] >= size()) return false;
            const Keyframe& keyframe = keyframes_[keyframes[n]];
            if (keyframe.fragment != f || keyframe.position != n) return false;
        }
        count += keyframes.size();
    }
    const auto is_sound = [](const Keyframe& keyframe) {
        return std::isfinite(keyframe.travelled) && are_in_reach(*keyframe.scan);
    };
    const auto connects = [&](const Edge& edge) {
        if (edge.from >= size() || edge.to >= size() || edge.from == edge.to) return false;
        const double length = keyframes_[edge.to].travelled - keyframes_[edge.from].travelled;
        return is_finite(edge.information) && (edge.is_robust || length >= 0.0); // for distances_from()
    };
    if (count != size() || poses_.size() != size()) return false;
    if (!std::ranges::all_of(keyframes_, is_sound) || !std::ranges::all_of(poses_, is_possible)) return false;
    if (!std::ranges::all_of(edges_, connects)) return false;
    if (newest_given_ && *newest_given_ >= size()) return false;
    if (!is_frozen_ || std::ranges::none_of(fragments_, &Fragment::is_located)) return true;
    return std::ranges::any_of(keyframes_, [&](const Keyframe& keyframe) { // the map that was frozen
        return keyframe.is_fixed && fragments_[keyframe.fragment].is_located;
    });
}

bool Submaps::is_consistent(const KeyframeGraph& graph) const {
    const auto fragments = graph.fragments();
    if (counts_.size() > fragments.size()) return false;
    for (std::size_t f = 0; f < counts_.size(); ++f) {
        if (counts_[f] > fragments[f].keyframes.size()) return false;
    }
    return std::ranges::all_of(submaps_, [&](const Submap& submap) {
        return submap.fragment < fragments.size() && submap.last < fragments[submap.fragment].keyframes.size() &&
               submap.anchor < graph.size() && submap.map.views().is_consistent();
    });
}

bool SharedMap::is_consistent() const {
    return graph_.is_consistent() && loops_.is_consistent(graph_) && fragments_.is_consistent(graph_);
}

bool Tracker::is_consistent() const {
    if (hypotheses_.empty() || hypotheses_.size() > kHypothesesMax) return false;
    if (hypotheses_.size() > 1 && open_count() == 0) return false;
    const auto has_open = [&](const Hypothesis& hypothesis) { return hypothesis.scans.size() == open_count(); };
    return open_count() < kOpenMax && std::ranges::all_of(hypotheses_, has_open) && map_.views().is_consistent();
}

bool TrajectoryEstimator::is_consistent() const {
    if (!tracker_.is_consistent() || first_.size() != placed_.size() + tracker_.open_count()) return false;
    if (!std::isfinite(hole_) || !std::isfinite(equal_for_) || !std::isfinite(drift_variance_) || drift_variance_ < 0.0)
        return false;
    const bool is_empty = first_.empty();
    if (placed_.empty() != is_empty || keyframes_.empty() != is_empty || fragments_.empty() != is_empty) return false;
    const auto is_own = [&](std::size_t fragment) {
        return fragment < graph().fragments().size() && graph().fragments()[fragment].robot == robot_ &&
               !graph().fragments()[fragment].is_given;
    };
    const auto is_keyframe = [&](std::size_t keyframe) { return keyframe < graph().size(); };
    const bool are_indices = std::ranges::all_of(fragments_, is_own) && std::ranges::all_of(keyframes_, is_keyframe) &&
                             std::ranges::all_of(placed_, is_keyframe, &PlacedScan::keyframe);
    if (!are_indices || (!is_empty && !is_keyframe(anchor_))) return false;
    if (!std::ranges::all_of(placed_, is_possible, &PlacedScan::T_keyframe_robot)) return false;
    if (!std::ranges::all_of(first_, is_possible, &FirstEstimate::pose)) return false;
    if (own_views_.size() > kLocalKeyframes || (is_empty && !own_views_.empty())) return false;
    return std::ranges::all_of(
        own_views_, [](const OwnView& view) { return are_in_reach(*view.scan) && is_possible(view.T_map_robot); });
}

} // namespace scanloom::slam
