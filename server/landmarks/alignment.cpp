#include "server/landmarks/alignment.hpp"

#include "server/landmarks/alignment_evidence.hpp"
#include "server/landmarks/alignment_search.hpp"
#include "server/landmarks/point_check.hpp"

#include <Eigen/Dense>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace scanloom::landmarks {
namespace {

constexpr std::size_t kPointsMin = 20;
constexpr double kDistanceMax = 100.0; // metres
constexpr std::size_t kHypotheses = 16;

// A pose that slides along a corridor comes to rest at whatever is near: it is tried every so often along its axis.
constexpr double kSlideStep = 0.05; // metres
constexpr int kSlideSteps = 12;     // to either side

constexpr double kContradiction = 2.0; // matches that one contradiction outweighs
constexpr double kMargin = 0.05;       // of the best score, by which it must be better than that of any rival,
constexpr double kMarginElements = 30; // and at least so many: a door is 1.2 m, seen from both sides
constexpr double kHeld = 0.02;         // of the elements used: less holds the pose in no direction
constexpr double kOverlapMin = 0.3;
constexpr double kElementsMin = 40;
constexpr double kContradictedMax = 0.15; // of what is matched or contradicted
constexpr double kSigmaMax = 0.006;       // metres

/// Neighbouring surface elements come from the same points: so many of them tell what one alone does.
constexpr double kShared = 6.0;

/// A view with its sensor at the origin.
struct View {
    Surface surface;
    Horizon horizon;
    Point2 from;

    explicit View(const CloudView& view) : View(around(view), view.from) {}

    [[nodiscard]] const std::vector<Surfel>& surfels() const { return surface.surfels(); }

private:
    View(const std::vector<Point2>& points, const Point2& from_)
        : surface(surfels_of(points)), horizon(points, {0.0, 0.0}), from(from_) {}

    static std::vector<Point2> around(const CloudView& view) {
        std::vector<Point2> points;
        points.reserve(view.points.size());
        for (const Point2& point : view.points) points.push_back(point - view.from);
        return points;
    }
};

/// A refined pose, and what speaks for it.
struct Candidate {
    LineFit fit;
    Evidence second_in_first;
    Evidence both;

    [[nodiscard]] const Pose2& pose() const { return fit.T_first_second; }
    [[nodiscard]] double score() const {
        return static_cast<double>(both.matched) - kContradiction * static_cast<double>(both.contradicted);
    }
};

Candidate judged(const View& first, const View& second, const Pose2& start) {
    Candidate candidate{.fit = fit_to_lines(first.surface, second.surface, start)};
    candidate.second_in_first = evidence_of(first.surface, first.horizon, second.surfels(), candidate.pose());
    candidate.both = candidate.second_in_first +
                     evidence_of(second.surface, second.horizon, first.surfels(), inverse(candidate.pose()));
    return candidate;
}

bool is_distinct(const Pose2& a, const Pose2& b) {
    return std::hypot(a.x - b.x, a.y - b.y) > kDistinctDistance ||
           std::abs(normalize_angle(a.yaw - b.yaw)) > kDistinctTurn;
}

/// The direction in which the lines hold the pose least, and how much, of the elements used.
struct WeakDirection {
    Point2 direction;
    double held;
};

WeakDirection weak_direction(const LineFit& fit) {
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
    const Eigen::Matrix2d translation = fit.normal_matrix.topLeftCorner<2, 2>();
    axes.computeDirect(translation / std::max(1.0, static_cast<double>(fit.used)));
    return {axes.eigenvectors().col(0), axes.eigenvalues()[0]};
}

/// By score, the best first.
void rank(std::vector<Candidate>& candidates) {
    std::ranges::stable_sort(candidates, std::greater(), &Candidate::score);
}

/// The best first, then those that say the same, then the others by score.
std::vector<Candidate> find_candidates(const View& first, const View& second, double distance_max) {
    std::vector<Candidate> candidates;
    for (const Pose2& hypothesis : find_hypotheses(first.surfels(), second.surfels(), distance_max, kHypotheses)) {
        candidates.push_back(judged(first, second, settle(first.surface, second.surfels(), hypothesis)));
    }
    if (candidates.empty()) return candidates;
    rank(candidates);
    const Pose2 best = candidates.front().pose();
    const Point2 along = weak_direction(candidates.front().fit).direction;
    for (int step = -kSlideSteps; step <= kSlideSteps; ++step) {
        const Point2 slid = kSlideStep * step * along;
        candidates.push_back(judged(first, second, {best.x + slid.x(), best.y + slid.y(), best.yaw}));
    }
    rank(candidates);
    const Pose2 winner = candidates.front().pose(); // and of those that say the same, the one that fits best
    const auto same = std::ranges::stable_partition(
        candidates, [&](const Candidate& candidate) { return !is_distinct(candidate.pose(), winner); });
    const auto fittest = std::ranges::max_element(candidates.begin(), same.begin(), {},
                                                  [](const Candidate& candidate) { return candidate.fit.agreement; });
    std::iter_swap(candidates.begin(), fittest);
    return candidates;
}

double share(std::size_t part, std::size_t all) {
    return all == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(all);
}

/// Puts in what is known of the fit, of n residuals and 3 unknowns.
void add_sigmas(const LineFit& fit, Alignment& alignment) {
    const double held = 1e-6 * std::max(1.0, static_cast<double>(fit.used)); // else it would be infinite
    const Eigen::Matrix3d covariance =
        kShared * fit.rms * fit.rms * (fit.normal_matrix + held * Eigen::Matrix3d::Identity()).inverse();
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
    axes.computeDirect(covariance.topLeftCorner<2, 2>());
    alignment.position_sigma = std::sqrt(std::max(0.0, axes.eigenvalues()[1]));
    alignment.yaw_sigma = std::sqrt(std::max(0.0, covariance(2, 2)));
}

std::optional<std::string> undetermined(const Candidate& best) {
    const Evidence& both = best.both;
    const double overlap = share(both.matched, both.elements);
    if (overlap < kOverlapMin || static_cast<double>(both.matched) < kElementsMin) {
        return fmt::format(
            "only {:.0f} % of the two views overlap, {} surface elements: take captures that are nearer to "
            "each other, or of more turns",
            100.0 * overlap, both.matched);
    }
    const double contradicted = share(both.contradicted, both.matched + both.contradicted);
    if (contradicted > kContradictedMax) {
        return fmt::format("{:.0f} % of what both could see is in one of the two views alone: it may not be the same "
                           "place, or much of it has moved",
                           100.0 * contradicted);
    }
    return std::nullopt;
}

/// Of the candidates, the best that is distinct from the first and nearly as good.
const Candidate* rival_of(const std::vector<Candidate>& candidates) {
    const Candidate& best = candidates.front();
    const double near = best.score() - std::max(kMargin * best.score(), kMarginElements);
    for (const Candidate& other : candidates) {
        if (other.score() >= near && is_distinct(other.pose(), best.pose())) return &other;
    }
    return nullptr;
}

/// With sensors at the origins.
Alignment judge(const std::vector<Candidate>& candidates) {
    if (candidates.empty()) {
        return {.why = "no pose lays anything of one view on the other: take captures that are nearer to each other"};
    }
    const Candidate& best = candidates.front();
    Alignment alignment{.T_first_second = best.pose(),
                        .certainty = Certainty::kClear,
                        .explained = share(best.second_in_first.matched, best.second_in_first.elements),
                        .contradicted = share(best.second_in_first.contradicted, best.second_in_first.elements),
                        .rms = best.fit.rms};
    add_sigmas(best.fit, alignment);
    if (auto why = undetermined(best)) {
        alignment.certainty = Certainty::kUndetermined;
        alignment.why = std::move(*why);
        return alignment;
    }
    const auto [direction, held] = weak_direction(best.fit);
    const Candidate* rival = rival_of(candidates);
    if (rival) alignment.rival = rival->pose();
    if (held < kHeld) {
        alignment.certainty = Certainty::kAmbiguous;
        alignment.why = fmt::format("hardly anything holds the pose along ({:.2f}, {:.2f}), as in a corridor: take a "
                                    "capture that shows where it ends",
                                    direction.x(), direction.y());
    } else if (rival) {
        const Pose2 apart = compose(inverse(best.pose()), rival->pose());
        alignment.certainty = Certainty::kAmbiguous;
        alignment.why = fmt::format("another pose, {:.2f} m and {:.0f} degrees away, explains {:.0f} % where this one "
                                    "explains {:.0f} %: take a capture where more can be told apart",
                                    std::hypot(apart.x, apart.y), std::abs(apart.yaw) * 180.0 / std::numbers::pi,
                                    100.0 * share(rival->both.matched, rival->both.elements),
                                    100.0 * share(best.both.matched, best.both.elements));
    } else if (alignment.position_sigma > kSigmaMax) {
        alignment.certainty = Certainty::kUndetermined;
        alignment.why =
            fmt::format("along ({:.2f}, {:.2f}) the place is known to within {:.0f} cm only, as what both "
                        "views show is little or far away: take captures of more turns, or nearer to things",
                        direction.x(), direction.y(), std::ceil(300.0 * alignment.position_sigma));
    }
    return alignment;
}

/// T between the clouds' own frames.
Pose2 with_origins(const Pose2& pose, const Point2& first_from, const Point2& second_from) {
    return compose({first_from.x(), first_from.y(), 0.0}, compose(pose, {-second_from.x(), -second_from.y(), 0.0}));
}

Result<> check(std::string_view name, const CloudView& view) {
    if (auto good = check_points(view.points, fmt::format("{}.points", name)); !good) return good;
    if (auto good = check_points({&view.from, 1}, fmt::format("{}.from", name)); !good) return good;
    if (view.points.size() < kPointsMin) {
        return Error{Errc::kInvalidField, fmt::format("{} has {} points; {} or more are needed to align it", name,
                                                      view.points.size(), kPointsMin)};
    }
    return {};
}

} // namespace

Result<Alignment> align(const CloudView& first, const CloudView& second, const AlignmentSettings& settings) {
    if (auto good = check("first", first); !good) return good.error();
    if (auto good = check("second", second); !good) return good.error();
    if (!(settings.distance_max > 0.0 && settings.distance_max <= kDistanceMax)) {
        return Error{Errc::kInvalidField, fmt::format("distance_max is {:g} m; it must be more than 0 and at most {:g}",
                                                      settings.distance_max, kDistanceMax)};
    }
    const View here(first);
    const View there(second);
    Alignment alignment = judge(find_candidates(here, there, settings.distance_max));
    alignment.T_first_second = with_origins(alignment.T_first_second, first.from, second.from);
    if (alignment.rival) alignment.rival = with_origins(*alignment.rival, first.from, second.from);
    return alignment;
}

} // namespace scanloom::landmarks
