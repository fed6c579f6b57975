#include "core/landmarks/alignment_hypotheses.hpp"

#include "core/landmarks/points.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <numbers>
#include <utility>

namespace scanloom::landmarks {
namespace {

constexpr int kRotations = 120;            // in a full turn
constexpr double kCell = 0.15;             // metres, side of a cell of translations
constexpr double kComparableCosine = 0.85; // cosine between normals of similar direction
constexpr std::size_t kPeaksMax = 6;       // for each rotation
constexpr double kApart = 0.3;             // metres between hypotheses of similar rotation
constexpr double kTurned = 7.0 * std::numbers::pi / 180.0;

struct Peak {
    Pose2 pose;
    int votes;
};

std::vector<Surfel> rotated(std::span<const Surfel> surfels, double yaw) {
    const Pose2 rotation{0.0, 0.0, yaw};
    std::vector<Surfel> turned;
    turned.reserve(surfels.size());
    for (const Surfel& surfel : surfels) turned.push_back(transformed(rotation, surfel));
    return turned;
}

/// Counts votes for translations in a grid of cells around the zero translation.
class Ballot {
public:
    explicit Ballot(double distance_max)
        : reach_((std::ceil(distance_max / kCell) + 1.0) * kCell),
          side_(2 * static_cast<int>(std::round(reach_ / kCell))),
          votes_(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_)) {}

    void vote(std::span<const Surfel> first, std::span<const Surfel> second) {
        std::ranges::fill(votes_, 0);
        for (const Surfel& there : second) {
            for (const Surfel& here : first) {
                const double x = here.position.x - there.position.x + reach_;
                const double y = here.position.y - there.position.y + reach_;
                if (!(x >= 0.0 && y >= 0.0 && x < 2.0 * reach_ && y < 2.0 * reach_)) continue;
                const bool comparable = here.is_straight() && there.is_straight();
                if (comparable && std::abs(dot(here.normal, there.normal)) < kComparableCosine) continue;
                ++votes_[index(static_cast<int>(x / kCell), static_cast<int>(y / kCell))];
            }
        }
    }

    /// Returns the squares of 2 x 2 cells with the most votes, without neighbours of a better square.
    [[nodiscard]] std::vector<Peak> peaks(double yaw, std::size_t count_max) const {
        std::vector<Peak> all;
        for (int y = 1; y + 2 < side_; ++y) {
            for (int x = 1; x + 2 < side_; ++x) {
                const int votes = square(x, y);
                if (votes == 0 || !is_peak(x, y, votes)) continue;
                all.push_back({{(x + 1) * kCell - reach_, (y + 1) * kCell - reach_, yaw}, votes});
            }
        }
        std::ranges::stable_sort(all, std::greater(), &Peak::votes);
        if (all.size() > count_max) all.resize(count_max);
        return all;
    }

private:
    [[nodiscard]] std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(std::min(y, side_ - 1)) * static_cast<std::size_t>(side_) +
               static_cast<std::size_t>(std::min(x, side_ - 1));
    }
    [[nodiscard]] int square(int x, int y) const {
        return votes_[index(x, y)] + votes_[index(x + 1, y)] + votes_[index(x, y + 1)] + votes_[index(x + 1, y + 1)];
    }
    [[nodiscard]] bool is_peak(int x, int y, int votes) const {
        return square(x - 1, y) < votes && square(x, y - 1) < votes && square(x + 1, y) <= votes &&
               square(x, y + 1) <= votes;
    }

    double reach_;
    int side_;
    std::vector<std::int32_t> votes_;
};

bool is_near(const Pose2& a, const Pose2& b) {
    return std::hypot(a.x - b.x, a.y - b.y) < kApart && std::abs(normalize_angle(a.yaw - b.yaw)) < kTurned;
}

/// Returns the poses of the best peaks; of peaks near each other only the one with the most votes.
std::vector<Pose2> likeliest(std::vector<Peak> peaks, std::size_t count_max) {
    std::ranges::stable_sort(peaks, std::greater(), &Peak::votes);
    std::vector<Pose2> hypotheses;
    for (const Peak& peak : peaks) {
        if (hypotheses.size() == count_max) break;
        const bool is_new =
            std::ranges::none_of(hypotheses, [&](const Pose2& pose) { return is_near(pose, peak.pose); });
        if (is_new) hypotheses.push_back(peak.pose);
    }
    return hypotheses;
}

} // namespace

std::vector<Surfel> sample(std::span<const Surfel> surfels, std::size_t count_max) {
    if (surfels.size() <= count_max) return {surfels.begin(), surfels.end()};
    std::vector<Surfel> some;
    for (std::size_t n = 0; n < count_max; ++n) some.push_back(surfels[n * surfels.size() / count_max]);
    return some;
}

Result<std::vector<Pose2>> find_hypotheses(std::span<const Surfel> first, std::span<const Surfel> second,
                                           double distance_max, std::size_t count_max, std::size_t first_max,
                                           const std::function<Result<>()>& ask) {
    const auto here = sample(first, first_max);
    const auto there = sample(second, kSurfelsMax);
    Ballot ballot(distance_max);
    std::vector<Peak> peaks;
    for (int n = 0; n < kRotations; ++n) {
        if (auto go_on = ask(); !go_on) return go_on.error();
        const double yaw = normalize_angle(2.0 * std::numbers::pi * n / kRotations);
        ballot.vote(here, rotated(there, yaw));
        std::ranges::copy(ballot.peaks(yaw, kPeaksMax), std::back_inserter(peaks));
    }
    return likeliest(std::move(peaks), count_max);
}

std::vector<Pose2> find_translations(std::span<const Surfel> first, std::span<const Surfel> second, double yaw,
                                     double distance_max, std::size_t count_max, std::size_t first_max) {
    Ballot ballot(distance_max);
    ballot.vote(sample(first, first_max), rotated(sample(second, kSurfelsMax), yaw));
    return likeliest(ballot.peaks(yaw, count_max), count_max);
}

namespace {

constexpr double kShiftStep = 0.05; // metres
constexpr int kShiftSteps = 12;     // to either side

constexpr double kLikelyScoreMin = 0.8; // fraction of the best score
constexpr std::size_t kLikelyMax = 4;

constexpr double kOutlierWeight = 2.0; // an outlier outweighs this many inliers

constexpr double kDistinctDistance = 0.1;   // metres; poses that differ by less are the same result
constexpr double kDistinctTurn = 0.0523599; // radians, 3 degrees

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
    return 2.0 * static_cast<double>(second_in_first.inliers) - kOutlierWeight * static_cast<double>(all.outliers);
}

Candidate make_candidate(const Seen& first, const Seen& second, const Pose2& start) {
    Candidate candidate{.fit = fit_to_lines(first.surface, second.surface, start)};
    candidate.second_in_first = evidence_of(first.surface, first.horizons, second.surface.surfels(), candidate.pose());
    candidate.first_in_second =
        evidence_of(second.surface, second.horizons, first.surface.surfels(), inverse(candidate.pose()));
    return candidate;
}

std::vector<Candidate> likely_candidates(std::vector<Candidate> candidates) {
    by_score(candidates);
    std::vector<Candidate> some;
    for (Candidate& candidate : candidates) {
        if (some.size() == kLikelyMax) break;
        if (!some.empty() && candidate.score() < kLikelyScoreMin * some.front().score()) break;
        const bool is_new =
            std::ranges::all_of(some, [&](const auto& one) { return is_distinct(one.pose(), candidate.pose()); });
        if (is_new) some.push_back(std::move(candidate));
    }
    return some;
}

void add_shifted(const Seen& first, const Seen& second, const Candidate& best, std::vector<Candidate>& candidates) {
    const Pose2 from = best.pose();
    const Point2 along = weak_direction(best.fit).direction;
    for (int step = -kShiftSteps; step <= kShiftSteps; ++step) {
        const Point2 shifted = kShiftStep * step * along;
        candidates.push_back(make_candidate(first, second, {from.x + shifted.x, from.y + shifted.y, from.yaw}));
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
