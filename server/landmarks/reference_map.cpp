#include "server/landmarks/reference_map.hpp"

#include <Eigen/Geometry>

#include <algorithm>

namespace scanloom::landmarks {
namespace {

constexpr double kBeenThere = 0.3; // metres from where somebody saw from

} // namespace

ReferenceMap::ReferenceMap(std::span<const std::shared_ptr<const ReferenceView>> views) {
    Eigen::AlignedBox2d bounds;
    for (const auto& view : views) {
        for (const auto& [x, y] : view->points) bounds.extend(Point2(x * 0.001, y * 0.001));
    }
    if (bounds.isEmpty()) return;
    middle_ = bounds.center();
    half_extent_ = 0.5 * bounds.sizes().maxCoeff();
    std::vector<Point2> all;
    horizons_.reserve(views.size());
    for (const auto& view : views) {
        const auto begin = static_cast<std::ptrdiff_t>(all.size());
        for (const auto& [x, y] : view->points) all.push_back(Point2(x * 0.001, y * 0.001) - middle_);
        horizons_.emplace_back(std::span<const Point2>(all.begin() + begin, all.end()), view->from - middle_);
    }
    surfels_ = surfels_of(all);
    std::erase_if(surfels_, [&](const Surfel& surfel) { return has_gone(surfel.position); });
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
    Seen seen{Surface(std::move(near)), {}};
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
