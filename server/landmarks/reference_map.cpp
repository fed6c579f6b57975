#include "server/landmarks/reference_map.hpp"

#include <Eigen/Geometry>

#include <algorithm>

namespace scanloom::landmarks {
namespace {

constexpr double kBeenThere = 0.3; // metres from where somebody saw from

} // namespace

std::optional<Extent> extent_of(ReferenceViewSpan views) {
    Eigen::AlignedBox2d bounds;
    for (const auto& view : views) {
        for (const PointMm& point : view->points) bounds.extend(in_metres(point));
    }
    if (bounds.isEmpty()) return std::nullopt;
    return Extent{bounds.center(), 0.5 * bounds.sizes().maxCoeff()};
}

Result<ReferenceMap> ReferenceMap::of(ReferenceViewSpan views, const Point2& middle,
                                      const std::function<Result<>()>& ask) {
    ReferenceMap map(middle);
    std::vector<std::vector<Point2>> points; // by view
    std::vector<CloudView> seen;
    map.horizons_.reserve(views.size());
    for (const auto& view : views) {
        if (auto go_on = ask(); !go_on) return go_on.error();
        auto& its = points.emplace_back();
        for (const PointMm& point : view->points) its.push_back(in_metres(point) - middle);
        seen.push_back({its, view->from - middle});
        map.horizons_.emplace_back(its, seen.back().from);
    }
    for (const Surfel& surfel : surfels_of(seen, kAroundOfMap)) {
        if (auto go_on = ask(); !go_on) return go_on.error();
        if (!map.has_gone(surfel.position)) map.surfels_.push_back(surfel);
    }
    return map;
}

bool ReferenceMap::has_gone(const Point2& place) const {
    int seen = 0;
    int looked_through = 0;
    for (const Horizon& horizon : horizons_) {
        if (!horizon.reaches(place)) continue;
        const auto verdict = horizon.at(place);
        looked_through += verdict == Horizon::Verdict::kOpen ? 1 : 0;
        seen += verdict == Horizon::Verdict::kUnknown ? 1 : 0;
    }
    return looked_through > seen;
}

Seen ReferenceMap::around(const Point2& place, double radius) const {
    std::vector<Surfel> near;
    std::ranges::copy_if(surfels_, std::back_inserter(near), [&](const Surfel& surfel) {
        return (surfel.position - place).squaredNorm() <= radius * radius;
    });
    Seen seen{Surface(std::move(near)), {}, true};
    for (const Horizon& horizon : horizons_) {
        const double far = radius + horizon.reach();
        if ((horizon.from() - place).squaredNorm() < far * far) seen.horizons.push_back(&horizon);
    }
    return seen;
}

bool ReferenceMap::is_possible(const Point2& place) const {
    return std::ranges::any_of(horizons_, [&](const Horizon& horizon) {
        if ((horizon.from() - place).squaredNorm() < kBeenThere * kBeenThere) return true;
        return horizon.reaches(place) && horizon.at(place) != Horizon::Verdict::kHidden;
    });
}

} // namespace scanloom::landmarks
