#include "core/landmarks/acceptance_test.hpp"

#include <Eigen/Dense>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::landmarks {
namespace {

constexpr double kMargin = 0.08;       // of the best score: no other pose may come this near to it,
constexpr double kMarginElements = 30; // or this near in elements: things may have moved
constexpr double kHeld = 0.02;         // of the elements used: below this, a direction is not constrained
constexpr double kElementsMin = 40;
constexpr double kContradictedMax = 0.1;       // outliers / (inliers + outliers) for two views,
constexpr double kContradictedInMapMax = 0.15; // and on a map

constexpr double kOverlapMin = 0.3;      // inlier ratio for two views
constexpr double kSigmaMax = 0.02 / 3.0; // metres for two views: 2 cm are three sigmas

/// Along a hall, a pose near the best has hardly fewer inliers of two views, because few elements constrain the pose in
/// that direction. It does not compete if the elements in which the two differ distinguish them clearly. The elements
/// that support the best must exceed the others by this number,
constexpr double kTelling = 20.0;
constexpr double kTellingRatio = 3.0;      // and by this factor;
constexpr double kTellingElsewhere = 10.0; // and by this number without all elements around any one place,
constexpr double kThingRadius = 1.0;       // metres: the size of one thing that may have moved.

/// A distant pose may be correct although it has fewer inliers: with two doors, one closed and one opened since, a room
/// may look like itself rotated by half a turn. The pose competes if it has this fraction of the best pose's inliers,
constexpr double kAsMuch = 0.9;
constexpr double kUnlikely = 8.0; // minus this many elements for each outlier that it has fewer.

constexpr double kFoundMin = 0.5;        // inlier ratio of a view on a map
constexpr double kSigmaInMapMax = 0.033; // metres: the map itself is no more accurate
constexpr double kOutOfPlaceMax = 0.06;  // of a view: outliers on a map

/// On a map, a pose with fewer inliers than the best competes as well, unless the best has this inlier ratio. It must
/// have
constexpr double kAllFound = 0.97;
constexpr double kRivalFoundMin = 0.3;    // this inlier ratio,
constexpr double kHardlyMore = 0.002;     // an outlier ratio at most this much above the best pose's,
constexpr double kElsewhere = 0.5;        // and be this far away, in metres,
constexpr double kTurnedElsewhere = 0.17; // or in radians, so that it is not the best pose itself

/// Neighbouring surface elements come from the same points, so this many of them count as one observation. Of 937 clear
/// alignments in the simulator's office and hall, one position was off by more than three sigmas, and ten yaws were.
constexpr double kShared = 12.0;

double share(std::size_t part, std::size_t all) {
    return all == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(all);
}

/// Returns the inlier ratio of what must overlap: of both views, or of the view on a map.
double overlap_of(const Candidate& candidate, LaidOn first) {
    const Evidence of = first == LaidOn::kView ? candidate.both() : candidate.second_in_first;
    return share(of.matched, of.elements);
}

double contradicted_of(const Candidate& candidate) {
    const Evidence both = candidate.both();
    return share(both.contradicted, both.matched + both.contradicted);
}

bool overlaps(const Candidate& candidate, LaidOn first, double overlap_min) {
    return overlap_of(candidate, first) >= overlap_min && static_cast<double>(candidate.both().matched) >= kElementsMin;
}

/// Sets the standard deviations of the fit, from its residuals and 3 unknowns.
void add_sigmas(const LineFit& fit, Alignment& alignment) {
    const double held = 1e-6 * std::max(1.0, static_cast<double>(fit.used)); // keeps the covariance finite
    const Eigen::Matrix3d covariance =
        kShared * fit.rms * fit.rms * (fit.normal_matrix + held * Eigen::Matrix3d::Identity()).inverse();
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
    axes.computeDirect(covariance.topLeftCorner<2, 2>());
    alignment.position_sigma = std::sqrt(std::max(0.0, axes.eigenvalues()[1]));
    alignment.yaw_sigma = std::sqrt(std::max(0.0, covariance(2, 2)));
}

std::optional<std::string> undetermined(const Candidate& best, LaidOn first) {
    const double percent = 100.0 * overlap_of(best, first);
    if (first == LaidOn::kView && !overlaps(best, first, kOverlapMin)) {
        return fmt::format(
            "only {:.0f} % of the two views overlap ({} surface elements); take captures that are nearer "
            "to each other, or of more turns",
            percent, best.both().matched);
    }
    if (first == LaidOn::kMap && !overlaps(best, first, kFoundMin)) {
        return fmt::format("only {:.0f} % of the view is in the map ({} surface elements); move to a place where more "
                           "is mapped",
                           percent, best.both().matched);
    }
    const double alone = share(best.second_in_first.contradicted, best.second_in_first.elements);
    if (first == LaidOn::kMap && alone > kOutOfPlaceMax) {
        return fmt::format("{:.0f} % of the view is in the free space of the map; it may be another place, or many "
                           "objects have moved",
                           100.0 * alone);
    }
    if (contradicted_of(best) > (first == LaidOn::kView ? kContradictedMax : kContradictedInMapMax)) {
        return fmt::format(
            "{:.0f} % of the surface visible from both places is in one view only; they may be different "
            "places, or many objects have moved",
            100.0 * contradicted_of(best));
    }
    return std::nullopt;
}

bool is_elsewhere(const Pose2& a, const Pose2& b) {
    return std::hypot(a.x - b.x, a.y - b.y) > kElsewhere || std::abs(normalize_angle(a.yaw - b.yaw)) > kTurnedElsewhere;
}

/// Returns whether the correct pose may be `other`, in an incomplete part of the map, and `best` may only look similar.
bool may_be_unfinished(const Candidate& other, const Candidate& best) {
    return overlap_of(best, LaidOn::kMap) < kAllFound && overlaps(other, LaidOn::kMap, kRivalFoundMin) &&
           contradicted_of(other) <= contradicted_of(best) + kHardlyMore && is_elsewhere(other.pose(), best.pose());
}

/// For two views, returns whether the elements in which a nearby pose differs from the best clearly support the best.
bool is_distinguished_from(const Candidate& best, const Candidate& other) {
    if (is_elsewhere(other.pose(), best.pose())) return false;
    const auto [for_best, for_other, of_one_thing] = difference(best, other, kThingRadius);
    const double more = for_best - for_other;
    return more >= kTelling && for_best >= kTellingRatio * for_other && more - of_one_thing >= kTellingElsewhere;
}

/// For two views, returns whether the correct pose may be the distant pose `other`.
bool may_be_elsewhere(const Candidate& other, const Candidate& best) {
    const auto worth = [](const Candidate& one, double as_much) {
        const Evidence both = one.both();
        return as_much * static_cast<double>(both.matched) - kUnlikely * static_cast<double>(both.contradicted);
    };
    return overlaps(other, LaidOn::kView, kOverlapMin) && worth(other, 1.0) >= worth(best, kAsMuch) &&
           is_elsewhere(other.pose(), best.pose());
}

/// Returns the best candidate that is distinct from the first and may be correct as well, or nullptr.
const Candidate* rival_of(const std::vector<Candidate>& candidates, LaidOn first) {
    const Candidate& best = candidates.front();
    const double near = best.score() - std::max(kMargin * best.score(), kMarginElements);
    for (const Candidate& other : candidates) {
        if (!is_distinct(other.pose(), best.pose())) continue;
        if (first == LaidOn::kMap) {
            if (other.score() >= near || may_be_unfinished(other, best)) return &other;
        } else if ((other.score() >= near && !is_distinguished_from(best, other)) || may_be_elsewhere(other, best)) {
            return &other;
        }
    }
    return nullptr;
}

std::string rivalled(const Candidate& best, const Candidate& rival, LaidOn first) {
    const Pose2 apart = compose(inverse(best.pose()), rival.pose());
    const bool is_likelier = first == LaidOn::kView && rival.both().contradicted < best.both().contradicted;
    return fmt::format("another pose, {:.2f} m and {:.0f} degrees away, matches {:.0f} % of the view, and this pose "
                       "matches {:.0f} %{}; move to a place with more distinct surroundings",
                       std::hypot(apart.x, apart.y), std::abs(apart.yaw) * 180.0 / std::numbers::pi,
                       100.0 * overlap_of(rival, first), 100.0 * overlap_of(best, first),
                       is_likelier ? ", but the other one has fewer outliers" : "");
}

} // namespace

Alignment judge(const std::vector<Candidate>& candidates, LaidOn first) {
    if (candidates.empty()) {
        return {.why = first == LaidOn::kView
                           ? "the two views do not match in any pose; take captures that are nearer to each other"
                           : "the view does not match the map in any pose; move to a place that is mapped"};
    }
    const Candidate& best = candidates.front();
    Alignment alignment{.T_first_second = best.pose(),
                        .certainty = Certainty::kClear,
                        .explained = share(best.second_in_first.matched, best.second_in_first.elements),
                        .contradicted = share(best.second_in_first.contradicted, best.second_in_first.elements),
                        .rms = best.fit.rms};
    add_sigmas(best.fit, alignment);
    if (auto why = undetermined(best, first)) {
        alignment.certainty = Certainty::kUndetermined;
        alignment.why = std::move(*why);
        return alignment;
    }
    const auto [direction, held] = weak_direction(best.fit);
    const Candidate* rival = rival_of(candidates, first);
    if (rival) alignment.rival = rival->pose();
    if (held < kHeld) {
        alignment.certainty = Certainty::kAmbiguous;
        alignment.why = fmt::format("the position along ({:.2f}, {:.2f}) is not determined, as in a corridor; move "
                                    "to a place from which its end is visible",
                                    direction.x, direction.y);
    } else if (rival) {
        alignment.certainty = Certainty::kAmbiguous;
        alignment.why = rivalled(best, *rival, first);
    } else if (alignment.position_sigma > (first == LaidOn::kView ? kSigmaMax : kSigmaInMapMax)) {
        alignment.certainty = Certainty::kUndetermined;
        alignment.why = fmt::format("the position along ({:.2f}, {:.2f}) is uncertain by {:.0f} cm, because the common "
                                    "surface is small or far away; take more turns, or move nearer to objects",
                                    direction.x, direction.y, std::ceil(300.0 * alignment.position_sigma));
    }
    return alignment;
}

} // namespace scanloom::landmarks
