#include "core/landmarks/pair_alignment.hpp"

#include "core/landmarks/points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace scanloom::landmarks {
namespace {

constexpr double kUndetermined = 1e-9; // relative to the value for points that agree
constexpr int kStepsMax = 50;
constexpr std::size_t kSeedsMax = 64;      // pairs that are combined, two at a time
constexpr double kCompetingWorthMin = 0.8; // of the best worth: another transform above this makes it ambiguous
constexpr std::size_t kAgreeingMin = 3;

Result<> check(std::span<const PointPair> pairs) {
    for (std::size_t n = 0; n < pairs.size(); ++n) {
        const auto& [first, second, weight] = pairs[n];
        if (auto good = check_points({&first, 1}, fmt::format("pairs[{}].first", n)); !good) return good;
        if (auto good = check_points({&second, 1}, fmt::format("pairs[{}].second", n)); !good) return good;
        if (!(weight >= 0.0) || !std::isfinite(weight)) {
            return Error{Errc::kInvalidField,
                         fmt::format("pairs[{}].weight is {:g}; it must be finite and 0 or more", n, weight)};
        }
    }
    return {};
}

double squared_distance(const Pose2& T_first_second, const PointPair& pair) {
    return squared_norm(pair.first - transform(T_first_second, pair.second));
}

/// Fits the transform to all pairs with weight.
/// Precondition: the pairs passed check().
Result<PairAlignment> least_squares(std::span<const PointPair> pairs) {
    PairAlignment fit;
    double heaviest = 0.0;
    for (const PointPair& pair : pairs) heaviest = std::max(heaviest, pair.weight);
    double weights = 0.0;
    Point2 first_centre{0.0, 0.0};
    Point2 second_centre{0.0, 0.0};
    for (std::size_t n = 0; n < pairs.size(); ++n) {
        if (pairs[n].weight == 0.0) continue;
        const double weight = pairs[n].weight / heaviest;
        fit.used.push_back(n);
        weights += weight;
        first_centre += weight * pairs[n].first;
        second_centre += weight * pairs[n].second;
    }
    if (fit.used.size() < 2) {
        return Error{Errc::kInvalidField,
                     fmt::format("pairs with weight: {}; a transform is determined by 2 or more", fit.used.size())};
    }
    first_centre /= weights;
    second_centre /= weights;
    double along = 0.0;
    double across = 0.0;
    double first_extent = 0.0;
    double second_extent = 0.0;
    for (const std::size_t n : fit.used) {
        const double weight = pairs[n].weight / heaviest;
        const Point2 first = pairs[n].first - first_centre;
        const Point2 second = pairs[n].second - second_centre;
        along += weight * dot(second, first);
        across += weight * (second.x * first.y - second.y * first.x);
        first_extent += weight * squared_norm(first);
        second_extent += weight * squared_norm(second);
    }
    const double size = std::max(max_abs(first_centre), max_abs(second_centre));
    const double rounding = 1e-14 * size * size * weights; // what remains of equal points minus their mean
    if (std::hypot(along, across) <= kUndetermined * std::sqrt(first_extent * second_extent) + rounding) {
        return Error{Errc::kInvalidField, "the pairs determine no rotation, as all points of one side are equal or any "
                                          "rotation fits them as well: give pairs that are further apart"};
    }
    const Pose2 rotation{0.0, 0.0, normalize_angle(std::atan2(across, along))};
    const Point2 translation = first_centre - transform(rotation, second_centre);
    fit.T_first_second = {translation.x, translation.y, rotation.yaw};
    double squares = 0.0;
    for (const std::size_t n : fit.used) {
        squares += pairs[n].weight / heaviest * squared_distance(fit.T_first_second, pairs[n]);
    }
    fit.rms = std::sqrt(squares / weights);
    return fit;
}

/// Pairs that agree on a transform.
struct Consensus {
    Pose2 T_first_second;
    std::vector<std::size_t> pairs; // ascending
    double worth = 0.0;             // sum of weights, each reduced with the pair's distance
};

Consensus consensus_on(const Pose2& T_first_second, std::span<const PointPair> pairs, double inlier_distance) {
    Consensus consensus{T_first_second, {}, 0.0};
    const double limit = inlier_distance * inlier_distance;
    for (std::size_t n = 0; n < pairs.size(); ++n) {
        const double squares = squared_distance(T_first_second, pairs[n]);
        if (pairs[n].weight == 0.0 || squares > limit) continue;
        consensus.pairs.push_back(n);
        consensus.worth += pairs[n].weight * (1.0 - squares / limit);
    }
    return consensus;
}

bool is_better(const Consensus& a, const Consensus& b) { return a.worth > b.worth; }

PointPair at(std::span<const PointPair> pairs, std::size_t n) { return {pairs[n].first, pairs[n].second, 1.0}; }

/// Fits the transform to the agreeing pairs repeatedly, as long as the consensus improves.
Consensus refitted(Consensus consensus, std::span<const PointPair> pairs, double inlier_distance) {
    for (int step = 0; step < kStepsMax && consensus.pairs.size() >= 2; ++step) {
        std::vector<PointPair> agreeing;
        for (const std::size_t n : consensus.pairs) agreeing.push_back(pairs[n]);
        const auto fit = least_squares(agreeing);
        if (!fit) break;
        Consensus next = consensus_on(fit->T_first_second, pairs, inlier_distance);
        if (!is_better(next, consensus)) break;
        consensus = std::move(next);
    }
    return consensus;
}

/// Calls `visit` with the consensus on the transform of each two pairs that are equally far apart in both frames.
template <class Visit>
void for_each_consensus(std::span<const PointPair> pairs, double inlier_distance, Visit visit) {
    std::vector<std::size_t> some; // evenly chosen, to bound the work
    const std::size_t step = pairs.size() / kSeedsMax + 1;
    for (std::size_t n = 0; n < pairs.size(); n += step) {
        if (pairs[n].weight > 0.0) some.push_back(n);
    }
    for (std::size_t i = 0; i < some.size(); ++i) {
        for (std::size_t j = i + 1; j < some.size(); ++j) {
            const PointPair a = at(pairs, some[i]);
            const PointPair b = at(pairs, some[j]);
            const double stretch = norm(a.first - b.first) - norm(a.second - b.second);
            if (std::abs(stretch) > 2.0 * inlier_distance) continue;
            const auto fit = least_squares(std::vector{a, b});
            if (fit) visit(consensus_on(fit->T_first_second, pairs, inlier_distance));
        }
    }
}

/// Returns whether less than half of the pairs of `a` are also in `b`.
bool is_other(const Consensus& a, const Consensus& b) {
    std::vector<std::size_t> common;
    std::ranges::set_intersection(a.pairs, b.pairs, std::back_inserter(common));
    return 2 * common.size() < a.pairs.size();
}

} // namespace

Result<PairAlignment> align_pairs(std::span<const PointPair> pairs) {
    if (auto good = check(pairs); !good) return good.error();
    return least_squares(pairs);
}

Result<PairAlignment> align_pairs_robustly(std::span<const PointPair> pairs, double inlier_distance) {
    if (auto good = check(pairs); !good) return good.error();
    if (!(inlier_distance > 0.0) || !std::isfinite(inlier_distance)) {
        return Error{Errc::kInvalidField,
                     fmt::format("inlier_distance is {:g} m; it must be finite and more than 0", inlier_distance)};
    }
    const auto with_weight = std::ranges::count_if(
        pairs, [](double weight) { return weight > 0.0; }, &PointPair::weight);
    if (with_weight < 2) return least_squares(pairs).error();
    Consensus best;
    for_each_consensus(pairs, inlier_distance, [&](Consensus found) {
        if (is_better(found, best)) best = std::move(found);
    });
    best = refitted(std::move(best), pairs, inlier_distance);
    if (best.pairs.size() < kAgreeingMin) {
        return Error{Errc::kInvalidField,
                     fmt::format("pairs that agree on a transform within {:g} m: {}; {} are needed: give "
                                 "more pairs or a larger inlier_distance",
                                 inlier_distance, best.pairs.size(), kAgreeingMin)};
    }
    Consensus competing;
    for_each_consensus(pairs, inlier_distance, [&](Consensus found) {
        if (is_other(found, best) && is_better(found, competing)) competing = std::move(found);
    });
    competing = refitted(std::move(competing), pairs, inlier_distance);
    if (is_other(competing, best) && competing.pairs.size() >= kAgreeingMin &&
        competing.worth >= kCompetingWorthMin * best.worth) {
        return Error{Errc::kAmbiguous, fmt::format("{} pairs agree on one transform and {} on another: give more pairs",
                                                   best.pairs.size(), competing.pairs.size())};
    }
    std::vector<PointPair> weighted(pairs.begin(), pairs.end());
    for (PointPair& pair : weighted) pair.weight = 0.0;
    for (const std::size_t n : best.pairs) weighted[n].weight = pairs[n].weight;
    return least_squares(weighted);
}

} // namespace scanloom::landmarks
