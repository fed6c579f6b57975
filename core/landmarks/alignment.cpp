#include "core/landmarks/alignment.hpp"

#include "core/landmarks/acceptance_test.hpp"
#include "core/landmarks/alignment_hypotheses.hpp"
#include "core/landmarks/points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

namespace scanloom::landmarks {
namespace {

constexpr double kDistanceMax = 100.0; // metres
constexpr std::size_t kHypotheses = 16;

/// Returns the points relative to the sensor position.
std::vector<Point2> around(const CloudView& view) {
    std::vector<Point2> points;
    points.reserve(view.points.size());
    for (const Point2& point : view.points) points.push_back(point - view.from);
    return points;
}

std::vector<Candidate> find_candidates(const Seen& first, const Seen& second, double distance_max) {
    std::vector<Candidate> candidates;
    const auto& here = first.surface.surfels();
    const auto& there = second.surface.surfels();
    const auto hypotheses = find_hypotheses(here, there, distance_max, kHypotheses).value(); // cannot fail
    for (const Pose2& hypothesis : hypotheses) {
        candidates.push_back(make_candidate(first, second, refine_by_icp(first.surface, there, hypothesis)));
    }
    if (candidates.empty()) return candidates;
    for (const Candidate& one : likely_candidates(candidates)) add_shifted(first, second, one, candidates);
    rank(candidates);
    return candidates;
}

/// Converts a pose between the sensor positions to one between the frames of the clouds.
Pose2 with_origins(const Pose2& pose, const Point2& first_from, const Point2& second_from) {
    return compose({first_from.x, first_from.y, 0.0}, compose(pose, {-second_from.x, -second_from.y, 0.0}));
}

} // namespace

Result<> check_view(std::string_view name, const CloudView& view) {
    if (auto good = check_points(view.points, fmt::format("{}.points", name)); !good) return good;
    if (auto good = check_points({&view.from, 1}, fmt::format("{}.from", name)); !good) return good;
    if (view.points.size() < kViewPointsMin) {
        return Error{Errc::kInvalidField, fmt::format("{} has {} points; {} or more are needed to align it", name,
                                                      view.points.size(), kViewPointsMin)};
    }
    return {};
}

Result<Alignment> align(const CloudView& first, const CloudView& second, const AlignmentSettings& settings) {
    if (auto good = check_view("first", first); !good) return good.error();
    if (auto good = check_view("second", second); !good) return good.error();
    if (!(settings.distance_max > 0.0 && settings.distance_max <= kDistanceMax)) {
        return Error{Errc::kInvalidField, fmt::format("distance_max is {:g} m; it must be more than 0 and at most {:g}",
                                                      settings.distance_max, kDistanceMax)};
    }
    const auto here = around(first);
    const auto there = around(second);
    const Horizon from_here(here, {0.0, 0.0});
    const Horizon from_there(there, {0.0, 0.0});
    const Seen seen_here{Surface(surfels_of(CloudView{here})), {&from_here}};
    const Seen seen_there{Surface(surfels_of(CloudView{there})), {&from_there}};
    Alignment alignment =
        test_acceptance(find_candidates(seen_here, seen_there, settings.distance_max), MatchedAgainst::kView);
    alignment.T_first_second = with_origins(alignment.T_first_second, first.from, second.from);
    if (alignment.competing_pose)
        alignment.competing_pose = with_origins(*alignment.competing_pose, first.from, second.from);
    return alignment;
}

} // namespace scanloom::landmarks
