#include "common/scan/limits.hpp"
#include "core/slam/trajectory_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

/// Whether members that were read fit together. Bytes can be damaged, or of another program, and still have correct
/// checksums; then no index may be beyond its end, and no map may be made of places too far apart for its memory.
namespace scanloom::slam {
namespace {

constexpr double kMapReachMax = 1000.0;           // metres: see PointMap
constexpr double kPoseMax = 2.0 * kCoordinateMax; // metres: estimates may be beyond the limit of odometry

bool is_within(const Transform2& T, double distance) {
    return std::fabs(T.x) <= distance && std::fabs(T.y) <= distance;
}

bool are_small(std::span<const scan_matching::SurfacePoint> points) {
    return std::ranges::all_of(points, [](const scan_matching::SurfacePoint& point) {
        return std::fabs(point.x) <= kMapReachMax && std::fabs(point.y) <= kMapReachMax;
    });
}

bool is_small(const KeyframeMap& map) {
    return std::ranges::all_of(
        map.views().views(), [](const scan_matching::View& view) { return is_within(view.T_map_robot, kMapReachMax); });
}

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
            if (keyframes[n] >= poses_.size()) return false;
            if (n == 0 || fragments_[f].is_given) continue;
            if (!is_within(inverse(poses_[keyframes[n - 1]]) * poses_[keyframes[n]], kMapReachMax)) return false;
        }
        count += keyframes.size();
    }
    const auto is_possible = [](const Keyframe& keyframe) {
        return std::isfinite(keyframe.travelled) && are_small(keyframe.scan->points);
    };
    const auto is_near = [](const Transform2& pose) { return is_within(pose, kPoseMax); };
    const auto connects = [&](const Edge& edge) {
        if (edge.from >= size() || edge.to >= size() || edge.from == edge.to) return false;
        const double length = keyframes_[edge.to].travelled - keyframes_[edge.from].travelled;
        return is_finite(edge.information) && (edge.is_robust || length >= 0.0); // for distances_from()
    };
    if (count != size() || poses_.size() != size()) return false;
    if (!std::ranges::all_of(keyframes_, is_possible) || !std::ranges::all_of(poses_, is_near)) return false;
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
               submap.anchor < graph.size() && is_small(submap.map);
    });
}

bool SharedMap::is_consistent() const {
    return graph_.is_consistent() && loops_.is_consistent(graph_) && fragments_.is_consistent(graph_);
}

bool Tracker::is_consistent() const {
    if (hypotheses_.empty() || hypotheses_.size() > kHypothesesMax) return false;
    if (hypotheses_.size() > 1 && open_count() == 0) return false;
    const auto has_open = [&](const Hypothesis& hypothesis) { return hypothesis.scans.size() == open_count(); };
    return open_count() < kOpenMax && std::ranges::all_of(hypotheses_, has_open) && is_small(map_) &&
           std::ranges::all_of(map_.views().views(), are_small, &scan_matching::View::points);
}

bool TrajectoryEstimator::is_consistent() const {
    if (!tracker_.is_consistent() || first_.size() != placed_.size() + tracker_.open_count()) return false;
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
    const auto is_near = [](const Transform2& pose) { return is_within(pose, kPoseMax); };
    if (!std::ranges::all_of(placed_, is_near, &PlacedScan::T_keyframe_robot)) return false;
    if (!std::ranges::all_of(first_, is_near, &FirstEstimate::pose)) return false;
    if (own_views_.size() > kLocalKeyframes || (is_empty && !own_views_.empty())) return false;
    return std::ranges::all_of(own_views_, [&](const OwnView& view) {
        return are_small(view.scan->points) &&
               is_within(inverse(graph().pose(anchor_)) * view.T_map_robot, kMapReachMax);
    });
}

} // namespace scanloom::slam
