#include "server/landmarks/alignment_of_pairs.hpp"

#include "server/landmarks/point_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace scanloom::landmarks {
namespace {

constexpr double kUndetermined = 1e-9; // of what the points' extents would give if they agreed
constexpr double kGrowth = 1.4;        // of the non-convexity, a step
constexpr int kStepsMax = 200;
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
    return (pair.first - transform(T_first_second, pair.second)).squaredNorm();
}

/// Pre  the pairs are checked.
Result<PairAlignment> least_squares(std::span<const PointPair> pairs) {
    PairAlignment fit;
    double heaviest = 0.0;
    for (const PointPair& pair : pairs) heaviest = std::max(heaviest, pair.weight);
    double weights = 0.0;
    Point2 first_centre(0.0, 0.0);
    Point2 second_centre(0.0, 0.0);
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
        along += weight * second.dot(first);
        across += weight * (second.x() * first.y() - second.y() * first.x());
        first_extent += weight * first.squaredNorm();
        second_extent += weight * second.squaredNorm();
    }
    const double size = std::max(first_centre.cwiseAbs().maxCoeff(), second_centre.cwiseAbs().maxCoeff());
    const double rounding = 1e-14 * size * size * weights; // of equal points, once their mean is taken off
    if (std::hypot(along, across) <= kUndetermined * std::sqrt(first_extent * second_extent) + rounding) {
        return Error{Errc::kInvalidField, "the pairs determine no rotation, as all points of one side are equal or any "
                                          "rotation fits them as well: give pairs that are further apart"};
    }
    const Pose2 rotation{0.0, 0.0, normalize_angle(std::atan2(across, along))};
    const Point2 translation = first_centre - transform(rotation, second_centre);
    fit.T_first_second = {translation.x(), translation.y(), rotation.yaw};
    double squares = 0.0;
    for (const std::size_t n : fit.used) {
        squares += pairs[n].weight / heaviest * squared_distance(fit.T_first_second, pairs[n]);
    }
    fit.rms = std::sqrt(squares / weights);
    return fit;
}

/// The weight of a pair between certainly used, 1, and certainly not, 0. The larger the control, the harder the cut.
double truncated_weight(double squares, double inlier_distance, double control) {
    const double inlier_squares = inlier_distance * inlier_distance;
    if (squares <= control / (control + 1.0) * inlier_squares) return 1.0;
    if (squares >= (control + 1.0) / control * inlier_squares) return 0.0;
    return std::clamp(inlier_distance * std::sqrt(control * (control + 1.0) / squares) - control, 0.0, 1.0);
}

double largest_squares(std::span<const PointPair> pairs, const Pose2& T_first_second) {
    double largest = 0.0;
    for (const PointPair& pair : pairs) {
        if (pair.weight > 0.0) largest = std::max(largest, squared_distance(T_first_second, pair));
    }
    return largest;
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
    auto fit = least_squares(pairs);
    if (!fit) return fit.error();
    const double inlier_squares = inlier_distance * inlier_distance;
    const double largest = largest_squares(pairs, fit->T_first_second);
    double control = largest > inlier_squares ? inlier_squares / (2.0 * largest - inlier_squares) : 1.0;
    std::vector<PointPair> weighted(pairs.begin(), pairs.end());
    for (int step = 0; step < kStepsMax; ++step) {
        bool is_settled = true;
        for (std::size_t n = 0; n < pairs.size(); ++n) {
            const double weight =
                truncated_weight(squared_distance(fit->T_first_second, pairs[n]), inlier_distance, control);
            if (weight > 0.0 && weight < 1.0) is_settled = false;
            weighted[n].weight = weight * pairs[n].weight;
        }
        if (is_settled && control > 1.0) break;
        auto next = least_squares(weighted);
        if (!next) return next.error();
        fit = std::move(next);
        control *= kGrowth;
    }
    for (std::size_t n = 0; n < pairs.size(); ++n) {
        const bool agrees = squared_distance(fit->T_first_second, pairs[n]) <= inlier_squares;
        weighted[n].weight = agrees ? pairs[n].weight : 0.0;
    }
    const auto agreeing = std::ranges::count_if(
        weighted, [](double weight) { return weight > 0.0; }, &PointPair::weight);
    if (static_cast<std::size_t>(agreeing) < kAgreeingMin) {
        return Error{Errc::kInvalidField,
                     fmt::format("pairs that agree on a transform within {:g} m: {}; {} are needed: give "
                                 "more pairs or a larger inlier_distance",
                                 inlier_distance, agreeing, kAgreeingMin)};
    }
    return least_squares(weighted);
}

} // namespace scanloom::landmarks
