#include "server/landmarks/matching.hpp"

#include "server/landmarks/point_check.hpp"
#include "server/landmarks/point_tree.hpp"

#include <fmt/format.h>

#include <cmath>

namespace scanloom::landmarks {

Result<std::vector<Match>> match(std::span<const Point2> first, std::span<const Point2> second, double tolerance) {
    if (auto good = check_points(first, "first"); !good) return good.error();
    if (auto good = check_points(second, "second"); !good) return good.error();
    if (!(tolerance >= 0.0) || !std::isfinite(tolerance)) {
        return Error{Errc::kInvalidField,
                     fmt::format("tolerance is {:g} m; it must be finite and 0 or more", tolerance)};
    }
    std::vector<Match> matches;
    if (first.empty() || second.empty()) return matches;
    const PointTree first_tree(first);
    const PointTree second_tree(second);
    for (std::size_t n = 0; n < first.size(); ++n) {
        const auto [there, distance] = *second_tree.nearest(first[n]);
        if (distance > tolerance) continue;
        if (first_tree.nearest(second[there])->index == n) matches.push_back({n, there, distance});
    }
    return matches;
}

} // namespace scanloom::landmarks
