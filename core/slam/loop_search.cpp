#include "core/slam/loop_search.hpp"

#include "core/scan_matching/agreement.hpp"
#include "core/scan_matching/line_matching.hpp"

#include <algorithm>
#include <cmath>

namespace scanloom::slam {
namespace {

constexpr std::size_t kEvery = 2;     // keyframes between searches
constexpr std::size_t kGap = 36;      // keyframes between the newest one and the end of a submap, at least
constexpr std::size_t kNearbyMax = 3; // nearest submaps that are matched
constexpr double kLoopReach = 5.0;    // metres between the robot and a submap's anchor, in addition to the drift
constexpr double kDrift = 0.03;       // of the length of the connection along the graph
constexpr double kDriftMax = 8.0;     // metres
constexpr std::size_t kMapsMax = 32;  // submaps whose points and seen space stay in memory

// The match of a keyframe with a submap.
constexpr double kWindowMin = 0.3;    // metres: standard deviation of the estimate
constexpr double kLoopGateMax = 0.8;  // metres
constexpr double kEstimateTurn = 0.3; // radians, standard deviation of the estimate
constexpr double kInlierRatioMin = 0.5;
constexpr double kOutlierRatioMax = 0.12;
constexpr double kConditioningMin = 0.04;
constexpr double kBeyondWindow = 0.1; // metres that a match may be outside the window

// Corrections up to here need one match.
constexpr double kDriftOfOneMatch = 1.5; // metres: with more drift, one match is not sufficient
constexpr double kSmallJump = 0.3;       // metres
constexpr double kSmallTurn = 0.1;       // radians
constexpr double kStretchPause = 3.0;    // metres travelled between stretch tests
constexpr double kStretchWindow = 1.0;   // metres, at least

constexpr double kLoopSigma = 0.02;           // metres
constexpr double kLoopTurnSigma = 0.005;      // radians
constexpr std::size_t kLoopsUnoptimized = 10; // at most
constexpr double kNoticeableJump = 0.05;      // metres; a turn of one radian counts as 2 m

} // namespace

void LoopSearch::search(KeyframeGraph& graph, std::size_t fragment) {
    const std::size_t keyframe = graph.fragments()[fragment].keyframes.back();
    if (graph[keyframe].position % kEvery != 0) return;
    submaps_.extend(graph, fragment);
    double largest_jump = 0.0;
    for (const NearbySubmap& near : nearest_submaps(graph, keyframe)) {
        const SubmapMatch found = match(graph, keyframe, near);
        if (is_large(near, found)) {
            if (try_stretch(graph, keyframe, near, found)) return;
            continue;
        }
        if (!found.agrees || !found.is_determined) {
            ++(found.agrees ? figures_.undetermined : figures_.disagreeing);
            continue;
        }
        graph.add_loop({submaps_[near.submap].anchor, keyframe, found.T_anchor_keyframe,
                        information_of(kLoopSigma, kLoopTurnSigma), true});
        largest_jump = std::max(largest_jump, found.jump + 2.0 * found.turn);
        ++figures_.loops;
        ++new_loops_;
        note_jump(found.jump);
    }
    if (largest_jump <= kNoticeableJump && new_loops_ < kLoopsUnoptimized) return;
    constexpr int kIterations = 2;
    new_loops_ = 0;
    ++optimizations_;
    graph.optimize(kIterations);
}

std::vector<LoopSearch::NearbySubmap> LoopSearch::nearest_submaps(const KeyframeGraph& graph,
                                                                  std::size_t keyframe) const {
    const auto lengths = graph.distances_from(keyframe);
    const Keyframe& searched = graph[keyframe];
    std::vector<NearbySubmap> submaps;
    for (std::size_t n = 0; n < submaps_.size(); ++n) {
        const Submap& submap = submaps_[n];
        if (!graph.share_frame(submap.anchor, keyframe)) continue;
        if (submap.fragment == searched.fragment && submap.last + kGap > searched.position) continue;
        const double distance = distance_of(inverse(graph.pose(submap.anchor)) * graph.pose(keyframe));
        const double drift = std::min(kDriftMax, kDrift * lengths[submap.anchor]);
        if (distance < kLoopReach + drift) submaps.push_back({n, distance, drift});
    }
    std::ranges::stable_sort(submaps, {}, &NearbySubmap::distance);
    if (submaps.size() > kNearbyMax) submaps.resize(kNearbyMax);
    return submaps;
}

LoopSearch::SubmapMatch LoopSearch::match(const KeyframeGraph& graph, std::size_t keyframe, const NearbySubmap& near) {
    ++figures_.matches;
    note_use(near.submap);
    Submap& submap = submaps_[near.submap];
    const ScanPoints& scan = *graph[keyframe].scan;
    const Transform2 expected = inverse(graph.pose(submap.anchor)) * graph.pose(keyframe);
    const double window = std::max(near.drift, kWindowMin);
    const auto found = match_to_lines(scan.points, submap.map.points(), expected, {expected, window, kEstimateTurn},
                                      {.steps_max = 15,
                                       .first_gate = std::min(kLoopGateMax, window),
                                       .last_gate = 0.15,
                                       .first_scale = 0.3,
                                       .last_scale = 0.05,
                                       .point_sigma = 0.03});
    const auto agreement = agreement_of(scan, submap.map.points(), submap.map.space(), found.T_map_robot);
    const Transform2 off = inverse(expected) * found.T_map_robot;
    const double jump = distance_of(off);
    const bool agrees =
        found.is_refined && agreement.inlier_ratio >= kInlierRatioMin && agreement.outlier_ratio <= kOutlierRatioMax;
    return {found.T_map_robot, jump, std::fabs(yaw_of(off)), agrees,
            found.conditioning >= kConditioningMin && jump <= window + kBeyondWindow};
}

bool LoopSearch::is_large(const NearbySubmap& near, const SubmapMatch& match) const {
    if (near.drift >= kDriftOfOneMatch) return true;
    return match.agrees && match.is_determined && (match.jump > kSmallJump || match.turn > kSmallTurn);
}

bool LoopSearch::try_stretch(KeyframeGraph& graph, std::size_t keyframe, const NearbySubmap& near,
                             const SubmapMatch& match) {
    const std::size_t fragment = graph[keyframe].fragment;
    if (next_test_at_.size() <= fragment) next_test_at_.resize(fragment + 1);
    if (graph[keyframe].travelled < next_test_at_[fragment]) return false;
    next_test_at_[fragment] = graph[keyframe].travelled + kStretchPause;
    ++figures_.stretch_tests;
    const std::size_t anchor = submaps_[near.submap].anchor;
    const Transform2 correction =
        match.agrees ? graph.pose(anchor) * match.T_anchor_keyframe * inverse(graph.pose(keyframe)) : Transform2();
    if (!accept_stretch(graph, {keyframe, anchor, correction, std::max(kStretchWindow, near.drift)})) return false;
    new_loops_ = 0;
    ++figures_.stretches_accepted;
    ++optimizations_;
    const Transform2 before = graph.pose(keyframe);
    graph.optimize_after_jump();
    note_jump(distance_of(inverse(before) * graph.pose(keyframe)));
    return true;
}

void LoopSearch::note_jump(double metres) {
    figures_.jump_sum += metres;
    const auto bound = std::ranges::lower_bound(LoopFigures::kJumpBounds, metres);
    ++figures_.jumps[static_cast<std::size_t>(bound - LoopFigures::kJumpBounds.begin())];
}

/// Frees the points and the seen space of the submaps that were not used for long.
void LoopSearch::note_use(std::size_t submap) {
    std::erase(used_, submap);
    used_.push_back(submap);
    if (used_.size() <= kMapsMax) return;
    submaps_[used_.front()].map.release();
    used_.pop_front();
}

} // namespace scanloom::slam
