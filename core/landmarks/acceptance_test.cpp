#include "core/landmarks/acceptance_test.hpp"

#include <Eigen/Dense>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::landmarks {
namespace {

constexpr double kScoreMargin = 0.08;       // of the best score: no other pose may come this near to it,
constexpr double kScoreMarginElements = 30; // or this near in elements: things may have moved
constexpr double kConstraintMin = 0.02;     // of the elements used: below this, a direction is not constrained
constexpr double kInliersMin = 40;          // of both surfaces
constexpr double kInlierRatioMin = 0.5;     // of the view
constexpr double kOutlierRatioMax = 0.15;   // outliers / (inliers + outliers) of both surfaces
constexpr double kViewOutlierRatioMax = 0.06;
constexpr double kSigmaMax = 0.033; // metres: the map itself is no more accurate

/// A pose with fewer inliers than the best competes as well, unless the best has this inlier ratio. It must have
constexpr double kCompleteInlierRatio = 0.97;
constexpr double kCompetingInlierRatioMin = 0.3; // this inlier ratio,
constexpr double kOutlierRatioTolerance = 0.002; // an outlier ratio at most this much above the best pose's,
constexpr double kElsewhereDistance = 0.5;       // and be this far away, in metres,
constexpr double kElsewhereTurn = 0.17;          // or in radians, so that it is not the best pose itself

/// Neighbouring surface elements come from the same points, so this many of them count as one observation. Of 937 clear
/// alignments in the simulator's office and hall, one position was off by more than three sigmas, and ten yaws were.
constexpr double kElementsPerObservation = 12.0;

double share(std::size_t part, std::size_t all) {
    return all == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(all);
}

/// Returns the fraction of the view that is in the map.
double inlier_ratio_of(const Candidate& candidate) {
    return share(candidate.second_in_first.inliers, candidate.second_in_first.elements);
}

double outlier_ratio_of(const Candidate& candidate) {
    const Evidence both = candidate.both();
    return share(both.outliers, both.inliers + both.outliers);
}

bool overlaps(const Candidate& candidate, double overlap_min) {
    return inlier_ratio_of(candidate) >= overlap_min && static_cast<double>(candidate.both().inliers) >= kInliersMin;
}

/// Sets the standard deviations of the fit, from its residuals and 3 unknowns.
void add_sigmas(const LineFit& fit, Alignment& alignment) {
    const double regularization = 1e-6 * std::max(1.0, static_cast<double>(fit.used)); // keeps the covariance finite
    const Eigen::Matrix3d covariance = kElementsPerObservation * fit.rms * fit.rms *
                                       (fit.normal_matrix + regularization * Eigen::Matrix3d::Identity()).inverse();
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
    axes.computeDirect(covariance.topLeftCorner<2, 2>());
    alignment.position_sigma = std::sqrt(std::max(0.0, axes.eigenvalues()[1]));
    alignment.yaw_sigma = std::sqrt(std::max(0.0, covariance(2, 2)));
}

std::optional<std::string> why_undetermined(const Candidate& best) {
    if (!overlaps(best, kInlierRatioMin)) {
        return fmt::format("only {:.0f} % of the view is in the map ({} surface elements); move to a place where more "
                           "is mapped",
                           100.0 * inlier_ratio_of(best), best.both().inliers);
    }
    const double alone = share(best.second_in_first.outliers, best.second_in_first.elements);
    if (alone > kViewOutlierRatioMax) {
        return fmt::format("{:.0f} % of the view is in the free space of the map; it may be another place, or many "
                           "objects have moved",
                           100.0 * alone);
    }
    if (outlier_ratio_of(best) > kOutlierRatioMax) {
        return fmt::format(
            "{:.0f} % of the surface visible from both places is in one view only; they may be different "
            "places, or many objects have moved",
            100.0 * outlier_ratio_of(best));
    }
    return std::nullopt;
}

bool is_elsewhere(const Pose2& a, const Pose2& b) {
    return std::hypot(a.x - b.x, a.y - b.y) > kElsewhereDistance ||
           std::abs(normalize_angle(a.yaw - b.yaw)) > kElsewhereTurn;
}

/// Returns whether the correct pose may be `other`, in an incomplete part of the map, and `best` may only look similar.
bool may_be_unfinished(const Candidate& other, const Candidate& best) {
    return inlier_ratio_of(best) < kCompleteInlierRatio && overlaps(other, kCompetingInlierRatioMin) &&
           outlier_ratio_of(other) <= outlier_ratio_of(best) + kOutlierRatioTolerance &&
           is_elsewhere(other.pose(), best.pose());
}

/// Returns the best candidate that is distinct from the first and may be correct as well, or nullptr.
const Candidate* competing_candidate(const std::vector<Candidate>& candidates) {
    const Candidate& best = candidates.front();
    const double near = best.score() - std::max(kScoreMargin * best.score(), kScoreMarginElements);
    for (const Candidate& other : candidates) {
        if (!is_distinct(other.pose(), best.pose())) continue;
        if (other.score() >= near || may_be_unfinished(other, best)) return &other;
    }
    return nullptr;
}

std::string ambiguity_text(const Candidate& best, const Candidate& competing) {
    const Pose2 apart = compose(inverse(best.pose()), competing.pose());
    return fmt::format("another pose, {:.2f} m and {:.0f} degrees away, matches {:.0f} % of the view, and this pose "
                       "matches {:.0f} %; move to a place with more distinct surroundings",
                       std::hypot(apart.x, apart.y), std::abs(apart.yaw) * 180.0 / std::numbers::pi,
                       100.0 * inlier_ratio_of(competing), 100.0 * inlier_ratio_of(best));
}

} // namespace

Alignment test_acceptance(const std::vector<Candidate>& candidates) {
    if (candidates.empty()) {
        return {.why = "the view does not match the map in any pose; move to a place that is mapped"};
    }
    const Candidate& best = candidates.front();
    Alignment alignment{.T_first_second = best.pose(),
                        .certainty = Certainty::kClear,
                        .inlier_ratio = inlier_ratio_of(best),
                        .outlier_ratio = share(best.second_in_first.outliers, best.second_in_first.elements),
                        .rms = best.fit.rms};
    add_sigmas(best.fit, alignment);
    if (auto why = why_undetermined(best)) {
        alignment.certainty = Certainty::kUndetermined;
        alignment.why = std::move(*why);
        return alignment;
    }
    const auto [direction, constraint] = weak_direction(best.fit);
    const Candidate* competing = competing_candidate(candidates);
    if (competing) alignment.competing_pose = competing->pose();
    if (constraint < kConstraintMin) {
        alignment.certainty = Certainty::kAmbiguous;
        alignment.why = fmt::format("the position along ({:.2f}, {:.2f}) is not determined, as in a corridor; move "
                                    "to a place from which its end is visible",
                                    direction.x, direction.y);
    } else if (competing) {
        alignment.certainty = Certainty::kAmbiguous;
        alignment.why = ambiguity_text(best, *competing);
    } else if (alignment.position_sigma > kSigmaMax) {
        alignment.certainty = Certainty::kUndetermined;
        alignment.why = fmt::format("the position along ({:.2f}, {:.2f}) is uncertain by {:.0f} cm, because the common "
                                    "surface is small or far away; take more turns, or move nearer to objects",
                                    direction.x, direction.y, std::ceil(300.0 * alignment.position_sigma));
    }
    return alignment;
}

} // namespace scanloom::landmarks
