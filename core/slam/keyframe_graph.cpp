#include "core/slam/keyframe_graph.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace scanloom::slam {
namespace {

// Standard deviations of the relative pose of two successive keyframes.
constexpr double kMatchedSigma = 0.015;     // metres
constexpr double kMatchedTurnSigma = 0.004; // radians

constexpr double kMetresPerRadian = 0.2; // of a turn, in the distance travelled
constexpr double kNearDistance = 30.0;   // metres between keyframes of one map
constexpr double kSamePlace = 0.4;       // metres: of keyframes that are closer, a map has one
constexpr double kSameTurn = 0.3;        // radians, likewise

} // namespace

std::size_t KeyframeGraph::begin_fragment(std::size_t robot, std::shared_ptr<const ScanPoints> scan,
                                          const Transform2& T_map_keyframe, bool is_located) {
    fragments_.push_back({robot, false, is_located, {size()}});
    keyframes_.push_back({.scan = std::move(scan), .fragment = fragments_.size() - 1});
    poses_.push_back(T_map_keyframe);
    return fragments_.size() - 1;
}

std::size_t KeyframeGraph::add_given(std::size_t robot, std::shared_ptr<const ScanPoints> scan,
                                     const Transform2& T_map_keyframe) {
    const auto is_same = [&](const Fragment& fragment) { return fragment.is_given && fragment.robot == robot; };
    const auto index = static_cast<std::size_t>(std::ranges::find_if(fragments_, is_same) - fragments_.begin());
    if (index == fragments_.size()) fragments_.push_back({robot, true, true, {}});
    Fragment& fragment = fragments_[index];
    // An edge without a length connects each with the one before, because all are exact: drift begins where a robot
    // leaves them.
    const auto before = fragment.keyframes.empty() ? newest_given_ : std::optional(fragment.keyframes.back());
    newest_given_ = size();
    if (before) {
        edges_.push_back({*before, size(), inverse(poses_[*before]) * T_map_keyframe,
                          information_of(kMatchedSigma, kMatchedTurnSigma)});
    }
    fragment.keyframes.push_back(size());
    keyframes_.push_back({std::move(scan), index, fragment.keyframes.size() - 1, true});
    poses_.push_back(T_map_keyframe);
    return index;
}

/// Returns the keyframes that do not move: those of a map that does not change, else the first one.
std::vector<std::size_t> KeyframeGraph::fixed() const {
    std::vector<std::size_t> fixed;
    for (std::size_t n = 0; n < size(); ++n) {
        if (keyframes_[n].is_fixed) fixed.push_back(n);
    }
    return fixed.empty() ? std::vector<std::size_t>{0} : fixed;
}

void KeyframeGraph::freeze(bool is_frozen) {
    is_frozen_ = is_frozen;
    for (Keyframe& keyframe : keyframes_) {
        const Fragment& fragment = fragments_[keyframe.fragment];
        keyframe.is_fixed = is_frozen ? fragment.is_located : fragment.is_given;
    }
}

void KeyframeGraph::add(std::size_t fragment, std::shared_ptr<const ScanPoints> scan,
                        const Transform2& T_newest_keyframe) {
    const Transform2& T = T_newest_keyframe;
    auto& keyframes = fragments_[fragment].keyframes;
    const std::size_t newest = keyframes.back();
    const double travelled =
        keyframes_[newest].travelled + distance_of(T) + kMetresPerRadian * std::fabs(scan_matching::yaw_of(T));
    edges_.push_back({newest, size(), T, information_of(kMatchedSigma, kMatchedTurnSigma)});
    poses_.push_back(poses_[newest] * T);
    keyframes.push_back(size());
    keyframes_.push_back({std::move(scan), fragment, keyframes.size() - 1, false, travelled});
}

void KeyframeGraph::move(std::size_t fragment, const Transform2& T_to_from, bool is_located) {
    fragments_[fragment].is_located = is_located;
    for (const std::size_t keyframe : fragments_[fragment].keyframes) {
        poses_[keyframe] = T_to_from * poses_[keyframe];
    }
}

void KeyframeGraph::add_loop(const Edge& edge) { edges_.push_back(edge); }

void KeyframeGraph::optimize(int iterations) {
    if (poses_.empty()) return;
    slam::optimize(poses_, fixed(), edges_, {.max_iterations = iterations});
}

void KeyframeGraph::optimize_after_jump() {
    if (poses_.empty()) return;
    constexpr int kIterations = 2; // of each pass
    optimize_gradually(poses_, fixed(), edges_, {.max_iterations = kIterations});
}

std::vector<double> KeyframeGraph::distances_from(std::size_t keyframe) const {
    struct Link {
        std::size_t to;
        double length;
    };
    std::vector<std::vector<Link>> links(size());
    for (const Edge& edge : edges_) {
        if (edge.is_robust && edge.weight < kUsedWeight) continue;
        const double length =
            edge.is_robust ? kLoopLength : keyframes_[edge.to].travelled - keyframes_[edge.from].travelled;
        links[edge.from].push_back({edge.to, length});
        links[edge.to].push_back({edge.from, length});
    }
    std::vector<double> distances(size(), std::numeric_limits<double>::infinity());
    using Reached = std::pair<double, std::size_t>;
    std::priority_queue<Reached, std::vector<Reached>, std::greater<>> open;
    distances[keyframe] = 0.0;
    open.emplace(0.0, keyframe);
    while (!open.empty()) {
        const auto [distance, from] = open.top();
        open.pop();
        if (distance > distances[from]) continue;
        for (const auto& [to, length] : links[from]) {
            if (distance + length >= distances[to]) continue;
            distances[to] = distance + length;
            open.emplace(distances[to], to);
        }
    }
    return distances;
}

KeyframeViews KeyframeGraph::views_around(std::size_t frame, std::size_t first, std::size_t last) const {
    const auto& keyframes = fragment_of(frame).keyframes;
    const std::size_t middle = keyframes_[frame].position;
    const Transform2 T_frame_map = inverse(poses_[frame]);
    KeyframeViews views;
    const auto add = [&](std::size_t position) {
        const std::size_t keyframe = keyframes[position];
        if (std::fabs(keyframes_[keyframe].travelled - keyframes_[frame].travelled) > kMapRadius) return;
        views.add(keyframes_[keyframe], keyframe == frame ? Transform2() : T_frame_map * poses_[keyframe]);
    };
    add(middle);
    for (std::size_t step = 1; middle + step <= last || middle >= first + step; ++step) {
        if (middle + step <= last) add(middle + step);
        if (middle >= first + step) add(middle - step);
    }
    return views;
}

KeyframeViews KeyframeGraph::views_near(std::size_t frame, std::size_t count, const Transform2& T_frame_robot) const {
    struct Near {
        std::size_t keyframe;
        Transform2 T_frame_keyframe;
        double distance;
    };
    const Transform2 T_frame_map = inverse(poses_[frame]);
    std::vector<Near> around;
    for (std::size_t n = 0; n < size(); ++n) {
        const Transform2 T_frame_keyframe = n == frame ? Transform2() : T_frame_map * poses_[n];
        const double distance = distance_of(T_frame_keyframe);
        if (is_in_map(n) && distance <= kNearDistance) around.push_back({n, T_frame_keyframe, distance});
    }
    std::ranges::stable_sort(around, {}, &Near::distance);
    std::vector<Near> chosen;
    KeyframeViews views({T_frame_robot.x, T_frame_robot.y});
    for (const Near& near : around) {
        if (chosen.size() == count) break;
        const bool is_known = std::ranges::any_of(chosen, [&](const Near& other) {
            const Transform2 off = inverse(other.T_frame_keyframe) * near.T_frame_keyframe;
            return distance_of(off) < kSamePlace && std::fabs(scan_matching::yaw_of(off)) < kSameTurn;
        });
        if (is_known) continue;
        views.add(keyframes_[near.keyframe], near.T_frame_keyframe);
        chosen.push_back(near);
    }
    return views;
}

} // namespace scanloom::slam
