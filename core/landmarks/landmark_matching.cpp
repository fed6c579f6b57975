#include "core/landmarks/landmark_matching.hpp"

#include "core/landmarks/point_index.hpp"
#include "core/landmarks/points.hpp"

#include <fmt/format.h>

#include <cassert>
#include <cmath>
#include <utility>

namespace scanloom::landmarks {
namespace {

/// The distinct points of a set, in the order of their first occurrence.
struct Distinct {
    explicit Distinct(std::span<const Point2> all) {
        auto [its_points, counts, of] = distinct_points(all);
        points = std::move(its_points);
        for (std::size_t n = 0; n < all.size(); ++n) {
            if (of[n] == first_of.size()) first_of.push_back(n);
        }
        tree = PointTree(points);
    }

    std::vector<Point2> points;
    std::vector<std::size_t> first_of; // for each distinct point, its lowest index in the set
    PointTree tree{{}};
};

} // namespace

Result<std::vector<Match>> match(std::span<const Point2> first, std::span<const Point2> second, double tolerance) {
    if (auto good = check_points(first, "first"); !good) return good.error();
    if (auto good = check_points(second, "second"); !good) return good.error();
    if (!(tolerance >= 0.0) || !std::isfinite(tolerance)) {
        return Error{Errc::kInvalidField,
                     fmt::format("tolerance is {:g} m; it must be finite and 0 or more", tolerance)};
    }
    std::vector<Match> matches;
    if (first.empty() || second.empty()) return matches;
    // Of equal points only the first can be matched. In trees of all points, each equal point would examine all the
    // others.
    const Distinct here(first);
    const Distinct there(second);
    for (std::size_t n = 0; n < here.points.size(); ++n) {
        const auto [other, distance] = *there.tree.nearest(here.points[n]);
        if (distance > tolerance) continue;
        if (here.tree.nearest(there.points[other])->index != n) continue;
        matches.push_back({here.first_of[n], there.first_of[other], distance});
    }
    return matches;
}

Metrics metrics_of(std::span<const Match> matches, std::size_t first_count, double tolerance) {
    assert(matches.size() <= first_count);
    Metrics metrics{.matched = matches.size()};
    const auto count = static_cast<double>(matches.size());
    if (first_count > 0) metrics.persistence = count / static_cast<double>(first_count);
    if (matches.empty()) return metrics;
    const auto close = std::ranges::count_if(
        matches, [&](double d) { return d <= tolerance / 2.0; }, &Match::distance);
    metrics.stability = static_cast<double>(close) / count;
    double sum = 0.0;
    for (const Match& match : matches) sum += match.distance;
    const double mean = sum / count;
    double squares = 0.0;
    for (const Match& match : matches) squares += (match.distance - mean) * (match.distance - mean);
    metrics.distance_mean = mean;
    metrics.distance_sigma = std::sqrt(squares / count);
    return metrics;
}

} // namespace scanloom::landmarks
