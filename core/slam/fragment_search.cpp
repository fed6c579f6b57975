#include "core/slam/fragment_search.hpp"

#include "core/scan_matching/square_set.hpp"
#include "core/slam/stretch_test.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace scanloom::slam {
namespace {

using scan_matching::PlaceSearch;
using scan_matching::SurfacePoint;

constexpr std::size_t kSearchEvery = 2; // keyframes between searches
constexpr double kQueryLength = 10.0;   // metres travelled by the keyframes that are looked up
constexpr std::size_t kPointsMax = 120; // of these
constexpr std::size_t kPointsMin = 40;  // fewer show no place
constexpr double kPointSquare = 0.3;    // metres: one point in each
constexpr std::size_t kStride = 23;     // from one of them to the next
constexpr double kScoreShare = 0.55;    // of the points, at least
constexpr double kRivalShare = 0.9;     // a place with a higher share of the best score is as good
constexpr std::size_t kMapRefresh = 20; // keyframes that may lack in the map
constexpr double kMapMoveMax = 0.2;     // metres: keyframes that moved farther outdate it
constexpr double kMapReach = 250.0;     // metres around the newest located keyframe

// Answers that agree.
constexpr std::size_t kAnswers = 3;
constexpr double kAnswersApart = 1.5;      // metres travelled between two of them
constexpr double kBaseline = 6.0;          // metres between the places of two of them, at least
constexpr double kAgreementDistance = 0.5; // metres
constexpr double kAgreementTurn = 0.1;     // radians
constexpr double kDriftPart = 0.03;        // of the way between two answers, in addition

constexpr double kWindow = 1.0; // metres, of the stretch test

} // namespace

bool FragmentSearch::search(KeyframeGraph& graph, std::size_t fragment) {
    const std::size_t keyframe = graph.fragments()[fragment].keyframes.back();
    if (graph[keyframe].position % kSearchEvery != 0) return false;
    const auto found = find(graph, fragment);
    if (!found) return false;
    if (answers_.size() <= fragment) answers_.resize(fragment + 1);
    auto& answers = answers_[fragment];
    answers.push_back({keyframe, *found});
    ++answer_count_;
    if (!is_confirmed(graph, answers)) return false;
    graph.move(fragment, *found, true);
    const std::size_t anchor = graph.fragments().front().keyframes.front();
    if (!accept_stretch(graph, {keyframe, anchor, Transform2(), kWindow})) {
        graph.move(fragment, inverse(*found), false);
        return false;
    }
    answers.clear();
    return true;
}

/// Returns whether the map lacks keyframes, or has some elsewhere.
bool FragmentSearch::is_outdated(const KeyframeGraph& graph, const std::vector<Located>& located) const {
    if (located.size() >= in_map_.size() + kMapRefresh) return true;
    return std::ranges::any_of(in_map_, [&](const Located& then) {
        const Transform2 off = inverse(then.T_map_keyframe) * graph.pose(then.keyframe);
        return distance_of(off) > kMapMoveMax;
    });
}

/// Makes the map of the located keyframes again if it is outdated.
void FragmentSearch::update_map(const KeyframeGraph& graph) {
    std::vector<Located> located;
    for (std::size_t n = 0; n < graph.size(); ++n) {
        if (graph.fragment_of(n).is_located) located.push_back({n, graph.pose(n)});
    }
    if (located.empty() || (map_ && !is_outdated(graph, located))) return;
    in_map_ = std::move(located);
    const Transform2& center = in_map_.back().T_map_keyframe;
    KeyframeViews views;
    for (const auto& [keyframe, pose] : in_map_) {
        const bool is_near = std::fabs(pose.x - center.x) <= kMapReach && std::fabs(pose.y - center.y) <= kMapReach;
        if (is_near) views.add(graph[keyframe], pose);
    }
    map_.emplace(views.views());
}

/// Looks up the newest keyframes of a fragment. Returns T_map_fragment.
std::optional<Transform2> FragmentSearch::find(const KeyframeGraph& graph, std::size_t fragment) {
    update_map(graph);
    if (!map_) return std::nullopt;
    const auto& keyframes = graph.fragments()[fragment].keyframes;
    const std::size_t newest = keyframes.back();
    const Transform2 T_newest_fragment = inverse(graph.pose(newest));
    constexpr std::size_t kSquaresMax = 8000; // within the reach
    scan_matching::SquareSet taken(kPointSquare, kSquaresMax);
    std::vector<SurfacePoint> points;
    for (std::size_t n = keyframes.size(); n-- > 0;) {
        const Keyframe& keyframe = graph[keyframes[n]];
        if (graph[newest].travelled - keyframe.travelled > kQueryLength) break;
        const Transform2 T_newest_keyframe = T_newest_fragment * graph.pose(keyframes[n]);
        for (const SurfacePoint& point : keyframe.scan->points) {
            const Point2 at = T_newest_keyframe * Point2{point.x, point.y};
            if (at.x * at.x + at.y * at.y > PlaceSearch::kReach * PlaceSearch::kReach) continue;
            if (taken.insert(at.x, at.y)) points.push_back(transform(T_newest_keyframe, point));
        }
    }
    if (points.size() < kPointsMin) return std::nullopt;
    std::vector<SurfacePoint> chosen; // each far from those before, so that a few show whether a place is wrong
    const std::size_t count = std::min(points.size(), kPointsMax);
    for (std::size_t first = 0; first < kStride; ++first) {
        for (std::size_t n = first; n < count; n += kStride) chosen.push_back(points[n * points.size() / count]);
    }
    const auto place = map_->find(
        chosen, {.score_min = static_cast<int>(kScoreShare * static_cast<double>(count)), .rival_share = kRivalShare});
    if (!place || place->rival_score > kRivalShare * place->score) return std::nullopt;
    return place->T_map_points * T_newest_fragment;
}

/// Returns whether enough answers agree with the newest one.
bool FragmentSearch::is_confirmed(const KeyframeGraph& graph, const std::vector<Answer>& answers) const {
    const Answer& newest = answers.back();
    const Transform2& pose = graph.pose(newest.keyframe); // in the fragment's frame
    std::size_t count = 1;
    double last_at = graph[newest.keyframe].travelled;
    double baseline = 0.0;
    for (std::size_t n = answers.size() - 1; n-- > 0;) {
        const Answer& other = answers[n];
        const double travelled = graph[newest.keyframe].travelled - graph[other.keyframe].travelled;
        const Transform2 off = inverse(newest.T_map_fragment * pose) * other.T_map_fragment * pose;
        const double allowed = kAgreementDistance + kDriftPart * travelled;
        if (distance_of(off) > allowed || std::fabs(yaw_of(off)) > kAgreementTurn) continue;
        baseline = std::max(baseline, distance_of(inverse(pose) * graph.pose(other.keyframe)));
        if (last_at - graph[other.keyframe].travelled < kAnswersApart) continue;
        last_at = graph[other.keyframe].travelled;
        ++count;
    }
    return count >= kAnswers && baseline >= kBaseline;
}

} // namespace scanloom::slam
