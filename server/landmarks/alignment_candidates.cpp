#include "server/landmarks/alignment_candidates.hpp"

#include "server/landmarks/eigen_point.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <utility>

namespace scanloom::landmarks {
namespace {

constexpr double kSlideStep = 0.05; // metres
constexpr int kSlideSteps = 12;     // to either side

constexpr double kLikely = 0.8; // fraction of the best score
constexpr std::size_t kLikelyMax = 4;

constexpr double kContradiction = 2.0; // an outlier outweighs this many inliers

double worth(Finding finding) {
    if (finding == Finding::kUnseen) return 0.0;
    return finding == Finding::kMatched ? 1.0 : -kContradiction;
}

void by_score(std::vector<Candidate>& candidates) {
    std::ranges::stable_sort(candidates, std::greater(), &Candidate::score);
}

} // namespace

bool is_distinct(const Pose2& a, const Pose2& b) {
    return std::hypot(a.x - b.x, a.y - b.y) > kDistinctDistance ||
           std::abs(normalize_angle(a.yaw - b.yaw)) > kDistinctTurn;
}

WeakDirection weak_direction(const LineFit& fit) {
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
    const Eigen::Matrix2d translation = fit.normal_matrix.topLeftCorner<2, 2>();
    axes.computeDirect(translation / std::max(1.0, static_cast<double>(fit.used)));
    return {from_eigen(axes.eigenvectors().col(0)), axes.eigenvalues()[0]};
}

double Candidate::score() const {
    const Evidence all = both();
    const std::size_t matched = is_on_map ? 2 * second_in_first.matched : all.matched;
    return static_cast<double>(matched) - kContradiction * static_cast<double>(all.contradicted);
}

Difference difference(const Candidate& one, const Candidate& other, double thing_radius) {
    assert(one.findings.size() == other.findings.size() && one.findings.size() == one.places.size());
    Difference between;
    std::vector<std::pair<Point2, double>> for_one;
    for (std::size_t i = 0; i < one.findings.size(); ++i) {
        const double more = worth(one.findings[i]) - worth(other.findings[i]);
        if (more > 0.0) for_one.emplace_back(one.places[i], more);
        (more > 0.0 ? between.for_one : between.for_other) += std::abs(more);
    }
    for (const auto& [middle, _] : for_one) {
        double around = 0.0;
        for (const auto& [place, more] : for_one) around += norm(place - middle) <= thing_radius ? more : 0.0;
        between.of_one_thing = std::max(between.of_one_thing, around);
    }
    return between;
}

Candidate judged(const Seen& first, const Seen& second, const Pose2& start) {
    Candidate candidate{.fit = fit_to_lines(first.surface, second.surface, start), .is_on_map = first.is_map};
    auto findings = findings_of(first.surface, first.horizons, second.surface.surfels(), candidate.pose());
    const auto of_first =
        findings_of(second.surface, second.horizons, first.surface.surfels(), inverse(candidate.pose()));
    candidate.second_in_first = evidence_of(findings);
    candidate.first_in_second = evidence_of(of_first);
    if (first.is_map) return candidate;
    findings.insert(findings.end(), of_first.begin(), of_first.end());
    candidate.findings = std::move(findings);
    for (const Surfel& there : second.surface.surfels()) {
        candidate.places.push_back(transform(candidate.pose(), there.position));
    }
    for (const Surfel& here : first.surface.surfels()) candidate.places.push_back(here.position);
    return candidate;
}

std::vector<Candidate> likely(std::vector<Candidate> candidates) {
    by_score(candidates);
    std::vector<Candidate> some;
    for (Candidate& candidate : candidates) {
        if (some.size() == kLikelyMax) break;
        if (!some.empty() && candidate.score() < kLikely * some.front().score()) break;
        const bool is_new =
            std::ranges::all_of(some, [&](const auto& one) { return is_distinct(one.pose(), candidate.pose()); });
        if (is_new) some.push_back(std::move(candidate));
    }
    return some;
}

void add_slid(const Seen& first, const Seen& second, const Candidate& best, std::vector<Candidate>& candidates) {
    const Pose2 from = best.pose();
    const Point2 along = weak_direction(best.fit).direction;
    for (int step = -kSlideSteps; step <= kSlideSteps; ++step) {
        const Point2 slid = kSlideStep * step * along;
        candidates.push_back(judged(first, second, {from.x + slid.x, from.y + slid.y, from.yaw}));
    }
}

void rank(std::vector<Candidate>& candidates) {
    if (candidates.empty()) return;
    by_score(candidates);
    const Pose2 winner = candidates.front().pose();
    const auto same_end = std::stable_partition(candidates.begin(), candidates.end(), [&](const Candidate& candidate) {
        return !is_distinct(candidate.pose(), winner);
    });
    const auto fittest = std::ranges::max_element(candidates.begin(), same_end, {},
                                                  [](const Candidate& candidate) { return candidate.fit.agreement; });
    std::iter_swap(candidates.begin(), fittest);
}

} // namespace scanloom::landmarks
