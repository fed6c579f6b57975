#include "core/slam/fragment_search.hpp"

#include "core/scan_matching/line_matching.hpp"
#include "core/scan_matching/square_set.hpp"
#include "core/slam/keyframe_map.hpp"
#include "core/slam/stretch_test.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace scanloom::slam {
namespace {

using scan_matching::PlaceMap;
using scan_matching::SurfacePoint;

constexpr std::size_t kPart = 8'000'000;        // lookups of a search between two keyframes
constexpr std::size_t kStep = 1'000'000;        // of these at each scan
constexpr std::size_t kLookupsMax = 12 * kPart; // of a search; one that takes more is given up
constexpr double kQueryLength = 10.0;           // metres travelled by the keyframes that are looked up
constexpr std::size_t kPointsMax = 120;         // of these
constexpr std::size_t kPointsMin = 40;          // fewer show no place
constexpr double kPointSquare = 0.3;            // metres: one point in each
constexpr std::size_t kStride = 23;             // from one of them to the next
constexpr double kScoreShare = 0.5;             // of the points, at least
constexpr double kRivalShare = 0.9;             // a place with a higher share of the best score is as good
constexpr double kExpectedLength = 20.0;        // metres travelled in which people's word counts
constexpr double kExpectedScoreShare = 0.7;     // likewise where people expect the robot
constexpr double kConnectedInliers = 0.5;       // of a keyframe's points, at least, that then fit the map
constexpr std::size_t kMapRefresh = 20;         // keyframes that may lack in the map
constexpr std::size_t kMapRefreshPart = 10;     // of all, a tenth if that is more
constexpr double kMapMoveMax = 0.2;             // metres: keyframes that moved farther outdate it
constexpr double kMapReach = 250.0;             // metres along each axis, around the newest located keyframe

// Answers that agree.
constexpr std::size_t kAnswers = 4;
constexpr double kAnswersApart = 1.5;          // metres travelled between two of them
constexpr double kBaseline = 10.0;             // metres between the places of two of them, at least
constexpr double kBaselineInCompleteMap = 2.0; // metres, likewise in a complete map
constexpr double kAgreementDistance = 0.5;     // metres
constexpr double kAgreementTurn = 0.1;         // radians
constexpr double kDriftPart = 0.03;            // of the distance travelled between two answers, in addition

constexpr double kWindow = 1.0; // metres, of the stretch test
// Share of its evidence that may contradict the map. A complete map is often older than what the robot sees.
constexpr double kContradictedMax = 0.02;
constexpr double kNoiseFactor = 1.5;
constexpr double kContradictedInCompleteMap = 0.08;

} // namespace

/// Goes on with a search, by at most this many lookups. @return whether it has ended
bool FragmentSearch::run(const KeyframeGraph& graph, Query& query, std::size_t lookups) {
    query.done = std::min(query.done + lookups, query.allowed);
    if (!query.search) make_search(graph, query, std::nullopt);
    return query.search->run(query.done);
}

void FragmentSearch::continue_search(const KeyframeGraph& graph, std::size_t fragment) {
    if (auto& query = searched(fragment).query) static_cast<void>(run(graph, *query, kStep));
}

bool FragmentSearch::search(KeyframeGraph& graph, std::size_t fragment) {
    Searched& state = searched(fragment);
    const auto newest_travelled = [&] { return graph[graph.fragments()[fragment].keyframes.back()].travelled; };
    if (state.expectation && newest_travelled() - graph[state.expectation->keyframe].travelled > kExpectedLength) {
        const bool is_tracked = std::exchange(state.expectation, std::nullopt)->is_tracked; // it was wrong
        if (is_tracked && locate(graph, fragment, Transform2())) return true;
    }
    if (state.expectation) {
        auto query = ask(graph, fragment, state.expectation);
        if (!query || !query->search->run(kPart)) return false;
        const auto found = query->answer();
        if (!found || !connect(graph, fragment, found->T_map_keyframe)) return false;
        state = Searched();
        return true;
    }
    std::optional<Query> query = std::exchange(state.query, std::nullopt);
    std::optional<Answer> found;
    if (query) {
        const bool has_ended = run(graph, *query, kPart);
        if (!has_ended && query->allowed < kLookupsMax) {
            query->allowed += kPart;
            state.query = std::move(query);
            return false;
        }
        if (has_ended) found = query->answer();
    }
    state.query = ask(graph, fragment, std::nullopt);
    return found && add_answer(graph, fragment, *found);
}

/// Adds the answer of a search. Locates the fragment there if answers agree.
bool FragmentSearch::add_answer(KeyframeGraph& graph, std::size_t fragment, const Answer& answer) {
    Searched& state = searched(fragment);
    state.answers.push_back(answer);
    if (!is_confirmed(graph, state.answers) || !locate(graph, fragment, answer.placement(graph))) return false;
    state = Searched();
    return true;
}

/// Moves a fragment to a place, and connects it with the map, if its newest part fits there.
bool FragmentSearch::locate(KeyframeGraph& graph, std::size_t fragment, const Transform2& T_map_fragment) const {
    const std::size_t newest = graph.fragments()[fragment].keyframes.back();
    const std::size_t anchor = std::ranges::find_if(graph.fragments(), &Fragment::is_located)->keyframes.front();
    graph.move(fragment, T_map_fragment, true);
    StretchQuestion question{newest, anchor, Transform2(), kWindow, kContradictedMax, kNoiseFactor};
    if (is_map_complete_) question = {newest, anchor, Transform2(), kWindow, kContradictedInCompleteMap};
    const bool fits = accept_stretch(graph, question);
    if (!fits) graph.move(fragment, inverse(T_map_fragment), false);
    return fits;
}

/// Moves a fragment to where its newest keyframe was found, refined by a match with the keyframes around, and connects
/// it with the nearest one. Returns whether it fits.
bool FragmentSearch::connect(KeyframeGraph& graph, std::size_t fragment, const Transform2& T_map_newest) {
    const std::size_t newest = graph.fragments()[fragment].keyframes.back();
    const Transform2& pose = T_map_newest;
    const auto is_near = [&](std::size_t keyframe) {
        return graph.is_in_map(keyframe) && distance_of(inverse(graph.pose(keyframe)) * pose) <= PlaceMap::kReach;
    };
    const auto nearest = graph.nearest(pose, is_near);
    if (!nearest) return false;
    KeyframeViews views({pose.x, pose.y});
    for (std::size_t n = graph.size(); n-- > 0;) {
        if (is_near(n)) views.add(graph[n], graph.pose(n));
    }
    KeyframeMap around(std::move(views));
    const auto match = match_to_lines(graph[newest].scan->points, around.points(), pose, {pose, 0.2, 0.1}, {});
    if (match.inlier_ratio < kConnectedInliers) return false;
    graph.add_loop({*nearest, newest, inverse(graph.pose(*nearest)) * match.T_map_robot,
                    information_of(kFitSigma, kFitTurnSigma), true});
    graph.move(fragment, match.T_map_robot * inverse(graph.pose(newest)), true);
    return true;
}

bool FragmentSearch::is_consistent(const KeyframeGraph& graph) const {
    const auto is_keyframe = [&](std::size_t keyframe) { return keyframe < graph.size(); };
    const auto is_map = [&](const LocatedMap& map) {
        return std::ranges::all_of(map.keyframes, [&](const Located& located) {
            return is_keyframe(located.keyframe) && is_near(located.T_map_keyframe, {0.0, 0.0}, kPoseMax);
        });
    };
    const auto is_possible = [&](const Searched& state) {
        if (!std::ranges::all_of(state.answers, is_keyframe, &Answer::keyframe)) return false;
        if (state.expectation && !is_keyframe(state.expectation->keyframe)) return false;
        if (!state.query) return true;
        const Query& query = *state.query;
        return is_keyframe(query.keyframe) && query.done <= query.allowed && query.allowed <= kLookupsMax &&
               query.points.size() >= kPointsMin && query.points.size() <= kPointsMax && is_map(*query.map) &&
               !query.map->keyframes.empty() && std::ranges::any_of(graph.fragments(), &Fragment::is_located);
    };
    return searched_.size() <= graph.fragments().size() && is_map(*map_) && std::ranges::all_of(searched_, is_possible);
}

void FragmentSearch::expect(std::size_t fragment, const Surroundings& place, std::size_t keyframe, bool is_tracked) {
    Searched& state = searched(fragment);
    state.expectation = {place, keyframe, is_tracked};
    state.query.reset(); // it searches everywhere
}

FragmentSearch::Searched& FragmentSearch::searched(std::size_t fragment) {
    if (searched_.size() <= fragment) searched_.resize(fragment + 1);
    return searched_[fragment];
}

/// Returns whether the map lacks keyframes, or has some elsewhere.
bool FragmentSearch::is_outdated(const KeyframeGraph& graph, const std::vector<Located>& located) const {
    const std::size_t count = map_->keyframes.size();
    if (located.size() >= count + std::max(kMapRefresh, count / kMapRefreshPart)) return true;
    return std::ranges::any_of(map_->keyframes, [&](const Located& then) {
        const Transform2 off = inverse(then.T_map_keyframe) * graph.pose(then.keyframe);
        return distance_of(off) > kMapMoveMax;
    });
}

/// Makes the map of the located keyframes again if it is outdated.
void FragmentSearch::update_map(const KeyframeGraph& graph) {
    std::vector<Located> located;
    for (std::size_t n = 0; n < graph.size(); ++n) {
        if (graph.is_in_map(n)) located.push_back({n, graph.pose(n)});
    }
    if (located.empty() || (!map_->keyframes.empty() && !is_outdated(graph, located))) return;
    const auto before = std::exchange(map_, std::make_shared<LocatedMap>(LocatedMap{std::move(located), nullptr}));
    for (Searched& state : searched_) { // a robot that stopped may have a query for good
        if (!state.query || state.query->map == before) continue;
        state.query->search.reset();
        state.query->map->places.reset();
    }
}

std::size_t FragmentSearch::place_map_count() const {
    std::set<const PlaceMap*> maps{map_->places.get()};
    for (const Searched& state : searched_) {
        if (state.query) maps.insert(state.query->map->places.get());
    }
    maps.erase(nullptr);
    return maps.size();
}

/// Returns the grids of a map, which are computed at the first call.
const std::shared_ptr<const PlaceMap>& FragmentSearch::places_of(const KeyframeGraph& graph, LocatedMap& map) {
    if (map.places) return map.places;
    const Transform2& center = map.keyframes.back().T_map_keyframe;
    KeyframeViews views({center.x, center.y}, 2.0 * kMapReach);
    for (const auto& [keyframe, pose] : map.keyframes) {
        const bool is_near = std::fabs(pose.x - center.x) <= kMapReach && std::fabs(pose.y - center.y) <= kMapReach;
        if (is_near) views.add(graph[keyframe], pose);
    }
    return map.places = std::make_shared<const PlaceMap>(views.views());
}

/// Makes the search of a query, up to its lookups that are done.
void FragmentSearch::make_search(const KeyframeGraph& graph, Query& query,
                                 const std::optional<Expectation>& expectation) {
    const double share = expectation ? kExpectedScoreShare : kScoreShare;
    scan_matching::PlaceQuestion question{
        .score_min = static_cast<int>(share * static_cast<double>(query.points.size())), .rival_share = kRivalShare};
    if (expectation) {
        const double moved = distance_of(inverse(graph.pose(expectation->keyframe)) * graph.pose(query.keyframe));
        question.center = expectation->place.near;
        question.radius = expectation->place.radius + moved;
    }
    query.search.emplace(places_of(graph, *query.map), query.points, question);
    query.search->run(query.done);
}

/// Begins to look up the newest keyframes of a fragment.
std::optional<FragmentSearch::Query> FragmentSearch::ask(const KeyframeGraph& graph, std::size_t fragment,
                                                         const std::optional<Expectation>& expectation) {
    update_map(graph);
    if (map_->keyframes.empty()) return std::nullopt;
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
            if (at.x * at.x + at.y * at.y > PlaceMap::kReach * PlaceMap::kReach) continue;
            if (taken.insert(at.x, at.y)) points.push_back(transform(T_newest_keyframe, point));
        }
    }
    if (points.size() < kPointsMin) return std::nullopt;
    std::vector<SurfacePoint> chosen; // each far from those before, so that a few show whether a place is wrong
    const std::size_t count = std::min(points.size(), kPointsMax);
    for (std::size_t first = 0; first < kStride; ++first) {
        for (std::size_t n = first; n < count; n += kStride) chosen.push_back(points[n * points.size() / count]);
    }
    Query query{newest, 0, kPart, map_, std::move(chosen), std::nullopt};
    make_search(graph, query, expectation);
    return query;
}

std::optional<FragmentSearch::Answer> FragmentSearch::Query::answer() const {
    const auto& place = search->place();
    if (!place || place->rival_score > kRivalShare * place->score) return std::nullopt;
    return Answer{keyframe, place->T_map_points};
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
        const Transform2 off = inverse(newest.T_map_keyframe) * other.placement(graph) * pose;
        const double allowed = kAgreementDistance + kDriftPart * travelled;
        if (distance_of(off) > allowed || std::fabs(yaw_of(off)) > kAgreementTurn) continue;
        baseline = std::max(baseline, distance_of(inverse(pose) * graph.pose(other.keyframe)));
        if (last_at - graph[other.keyframe].travelled < kAnswersApart) continue;
        last_at = graph[other.keyframe].travelled;
        ++count;
    }
    const double wanted = is_map_complete_ ? kBaselineInCompleteMap : kBaseline;
    return count >= kAnswers && baseline >= wanted;
}

} // namespace scanloom::slam
