#include "server/landmarks/matching.hpp"

#include "server/landmarks/distinct_points.hpp"
#include "server/landmarks/point_check.hpp"
#include "server/landmarks/point_tree.hpp"

#include <fmt/format.h>

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

} // namespace scanloom::landmarks
