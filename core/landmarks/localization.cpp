#include "core/landmarks/localization.hpp"

#include "common/scan/limits.hpp"
#include "core/landmarks/acceptance_test.hpp"
#include "core/landmarks/alignment_hypotheses.hpp"
#include "core/landmarks/points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::landmarks {
namespace {

constexpr double kHalfExtentMax = 100.0; // metres
constexpr std::size_t kMapHypotheses = 48;
constexpr std::size_t kRepetitions = 12;     // for each quarter turn
constexpr std::size_t kMapSurfelsMax = 4000; // at most this many are used, evenly chosen
constexpr std::size_t kViewSurfelsMax = 4000;
constexpr double kBeyond = 1.0; // metres of the map that are used beyond the view's range

/// Returns the distance of two places along the axis where it is larger, in metres.
double apart(const Point2& a, const Point2& b) { return max_abs(a - b); }

/// Returns the views that may show something visible from within the neighbourhood.
ReferenceViews views_near(const ReferenceViews& views, const Neighbourhood& near, double reach) {
    ReferenceViews some;
    std::ranges::copy_if(views, std::back_inserter(some), [&](const auto& view) {
        return std::ranges::any_of(view->points, [&](const PointMm& point) {
            return apart(in_metres(point), near.middle) <= near.radius + reach;
        });
    });
    return some;
}

Result<> check_view(const CloudView& view) {
    if (auto good = check_points(view.points, "the view.points"); !good) return good;
    if (auto good = check_points({&view.from, 1}, "the view.from"); !good) return good;
    if (view.points.size() < kViewPointsMin) {
        return Error{Errc::kInvalidField, fmt::format("the view has {} points; {} or more are needed to align it",
                                                      view.points.size(), kViewPointsMin)};
    }
    return {};
}

/// Returns the surface elements of a view, at most kViewSurfelsMax, evenly chosen. A view of a room has some hundreds.
std::vector<Surfel> some_surfels_of(const std::vector<Point2>& points) {
    return sample(surfels_of({&points, 1}), kViewSurfelsMax);
}

/// The search for the pose of a view in a map.
class Search {
public:
    /// @param within  in the map's own frame
    Search(const ReferenceMap& map, const Neighbourhood& within, const Horizon& horizon,
           const std::vector<Point2>& points);

    [[nodiscard]] Result<std::vector<Pose2>> hypotheses(const std::function<Result<>()>& ask) const;
    /// Returns hypotheses for a rotation. Where things repeat, the correct pose may have fewer votes than others; but
    /// walls are parallel.
    [[nodiscard]] std::vector<Pose2> repetitions(double yaw) const;
    /// Refines a hypothesis and adds the result if a sensor can be there.
    void add(const Pose2& hypothesis, std::vector<Candidate>& candidates) const;
    [[nodiscard]] Result<> add_shifted_candidates(std::vector<Candidate>& candidates,
                                                  const std::function<Result<>()>& ask) const;

private:
    [[nodiscard]] std::vector<Pose2> in_map(std::vector<Pose2> poses) const;
    [[nodiscard]] bool is_possible(const Candidate& candidate) const {
        return map_.is_possible({candidate.pose().x, candidate.pose().y});
    }

    const ReferenceMap& map_;
    Neighbourhood within_;
    Seen second_;
    double reach_;
    std::vector<Surfel> near_; // what may be visible from the neighbourhood, relative to its middle
};

Search::Search(const ReferenceMap& map, const Neighbourhood& within, const Horizon& horizon,
               const std::vector<Point2>& points)
    : map_(map), within_(within), second_{Surface(some_surfels_of(points)), {&horizon}},
      reach_(horizon.reach() + kBeyond) {
    for (Surfel surfel : map_.surfels()) {
        if (apart(surfel.position, within_.middle) > within_.radius + reach_) continue;
        surfel.position -= within_.middle;
        near_.push_back(surfel);
    }
}

Result<std::vector<Pose2>> Search::hypotheses(const std::function<Result<>()>& ask) const {
    auto found = find_hypotheses(near_, second_.surface.surfels(), within_.radius, kMapHypotheses, kMapSurfelsMax, ask);
    if (!found) return found;
    return in_map(std::move(*found));
}

std::vector<Pose2> Search::repetitions(double yaw) const {
    return in_map(
        find_translations(near_, second_.surface.surfels(), yaw, within_.radius, kRepetitions, kMapSurfelsMax));
}

std::vector<Pose2> Search::in_map(std::vector<Pose2> poses) const {
    for (Pose2& pose : poses) pose = {pose.x + within_.middle.x, pose.y + within_.middle.y, pose.yaw};
    return poses;
}

void Search::add(const Pose2& hypothesis, std::vector<Candidate>& candidates) const {
    const Seen first = map_.around({hypothesis.x, hypothesis.y}, reach_);
    if (first.surface.surfels().empty()) return;
    candidates.push_back(
        make_candidate(first, second_, refine_by_icp(first.surface, second_.surface.surfels(), hypothesis)));
    if (!is_possible(candidates.back())) candidates.pop_back();
}

Result<> Search::add_shifted_candidates(std::vector<Candidate>& candidates,
                                        const std::function<Result<>()>& ask) const {
    const auto begin = static_cast<std::ptrdiff_t>(candidates.size());
    for (const Candidate& one : likely_candidates(candidates)) {
        if (auto go_on = ask(); !go_on) return go_on;
        add_shifted(map_.around({one.pose().x, one.pose().y}, reach_), second_, one, candidates);
    }
    const auto impossible = std::remove_if(candidates.begin() + begin, candidates.end(),
                                           [&](const Candidate& candidate) { return !is_possible(candidate); });
    candidates.erase(impossible, candidates.end());
    return {};
}

/// Returns the neighbourhood relative to the middle of the extent, not larger than the extent requires.
Neighbourhood within(const Extent& extent, const std::optional<Neighbourhood>& near) {
    if (!near) return {{0.0, 0.0}, extent.half};
    const Point2 middle = near->middle - extent.middle;
    return {middle, std::min(near->radius, extent.half + apart(middle, {0.0, 0.0}))};
}

/// Returns the reason why nothing can be found. Other places may be mapped.
std::string nothing_there(const std::optional<Neighbourhood>& near) {
    if (!near) return "no surface of this map is still valid; move to a place that was mapped recently";
    return fmt::format("the map has no laser points within {:g} m of ({:g}, {:g}); give another place, or none",
                       near->radius, near->middle.x, near->middle.y);
}

} // namespace

Result<Alignment> locate(const ReferenceViews& views, const CloudView& view, const std::optional<Neighbourhood>& near,
                         const std::function<Result<>()>& ask) {
    if (auto good = check_view(view); !good) return good.error();
    std::vector<Point2> points;
    for (const Point2& point : view.points) points.push_back(point - view.from);
    const Horizon horizon(points, {0.0, 0.0});

    if (views.empty()) {
        return Error{Errc::kNothingMapped,
                     "this session has no laser points yet; send the first scans from a pose that is known"};
    }
    const ReferenceViews some = near ? views_near(views, *near, horizon.reach() + kBeyond) : views;
    const auto extent = extent_of(some);
    if (!extent) return Alignment{.why = nothing_there(near)};
    const Neighbourhood where = within(*extent, near);
    if (where.radius > kHalfExtentMax) {
        return Error{
            Errc::kTooLarge,
            fmt::format("the search would cover {:.0f} m of the map, and the limit is {:.0f} m; give a point near the "
                        "robot's position, and the distance",
                        2.0 * where.radius, 2.0 * kHalfExtentMax)};
    }
    const auto map = ReferenceMap::of(some, extent->middle, ask);
    if (!map) return map.error();
    if (map->is_empty()) return Alignment{.why = nothing_there(near)};
    const Search search(*map, where, horizon, points);
    const auto hypotheses = search.hypotheses(ask);
    if (!hypotheses) return hypotheses.error();
    std::vector<Candidate> candidates;
    for (const Pose2& hypothesis : *hypotheses) {
        if (auto go_on = ask(); !go_on) return go_on.error();
        search.add(hypothesis, candidates);
    }
    if (!candidates.empty()) {
        const double yaw = std::ranges::max_element(candidates, {}, &Candidate::score)->pose().yaw;
        for (int quarter = 0; quarter < 4; ++quarter) {
            for (const Pose2& hypothesis : search.repetitions(yaw + quarter * 0.5 * std::numbers::pi)) {
                if (auto go_on = ask(); !go_on) return go_on.error();
                search.add(hypothesis, candidates);
            }
        }
    }
    if (auto shifted = search.add_shifted_candidates(candidates, ask); !shifted) return shifted.error();
    std::erase_if(candidates, [&](const Candidate& candidate) {
        return apart({candidate.pose().x, candidate.pose().y}, where.middle) > where.radius;
    });
    rank(candidates);
    Alignment found = test_acceptance(candidates);
    const auto in_map = [&](const Pose2& pose) {
        return compose({map->middle().x, map->middle().y, 0.0}, compose(pose, {-view.from.x, -view.from.y, 0.0}));
    };
    found.T_first_second = in_map(found.T_first_second);
    if (found.competing_pose) found.competing_pose = in_map(*found.competing_pose);
    return found;
}

} // namespace scanloom::landmarks
