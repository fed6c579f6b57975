#include "core/slam/keyframe_graph.hpp"

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace scanloom::slam {
namespace {

// Standard deviations of the relative pose of two successive keyframes.
constexpr double kMatchedSigma = 0.015;      // metres
constexpr double kMatchedTurnSigma = 0.004;  // radians
constexpr double kPredictedSigma = 0.1;      // metres
constexpr double kPredictedTurnSigma = 0.05; // radians

constexpr double kMetresPerRadian = 0.2;  // of a turn, in the distance travelled
constexpr double kMapDistanceMax = 100.0; // metres travelled between keyframes of one map; bounds its memory

constexpr std::array<std::size_t, 1> kFixed{0};

} // namespace

void KeyframeGraph::add(std::shared_ptr<const ScanPoints> scan, const Transform2& T_newest_keyframe, bool is_matched) {
    if (keyframes_.empty()) {
        keyframes_.push_back({std::move(scan)});
        poses_.push_back(T_newest_keyframe);
        return;
    }
    const Transform2& T = T_newest_keyframe;
    double travelled = distance_of(T) + kMetresPerRadian * std::fabs(scan_matching::yaw_of(T));
    if (!is_matched) travelled += kMapDistanceMax; // maps of one frame then do not contain both keyframes
    const auto information = is_matched ? information_of(kMatchedSigma, kMatchedTurnSigma)
                                        : information_of(kPredictedSigma, kPredictedTurnSigma);
    edges_.push_back({size() - 1, size(), T, information});
    poses_.push_back(poses_.back() * T);
    keyframes_.push_back({std::move(scan), is_matched, keyframes_.back().travelled + travelled});
}

void KeyframeGraph::add_loop(const Edge& edge) { edges_.push_back(edge); }

void KeyframeGraph::optimize(int iterations) {
    if (poses_.empty()) return; // kFixed names the first keyframe
    slam::optimize(poses_, kFixed, edges_, {.max_iterations = iterations});
}

void KeyframeGraph::optimize_after_jump() {
    if (poses_.empty()) return;
    constexpr int kIterations = 2; // of each pass
    optimize_gradually(poses_, kFixed, edges_, {.max_iterations = kIterations});
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

KeyframeViews KeyframeGraph::views_around(std::size_t first, std::size_t last, std::size_t frame) const {
    const Transform2 T_frame_map = inverse(poses_[frame]);
    KeyframeViews views;
    const auto add = [&](std::size_t keyframe) {
        if (std::fabs(keyframes_[keyframe].travelled - keyframes_[frame].travelled) > kMapDistanceMax) return;
        views.add(keyframes_[keyframe], keyframe == frame ? Transform2() : T_frame_map * poses_[keyframe]);
    };
    add(frame);
    for (std::size_t step = 1; frame + step <= last || frame >= first + step; ++step) {
        if (frame + step <= last) add(frame + step);
        if (frame >= first + step) add(frame - step);
    }
    return views;
}

} // namespace scanloom::slam
