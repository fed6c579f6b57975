#include "core/landmarks/reference_map.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

namespace scanloom::landmarks {
namespace {

std::size_t size_of(const ReferenceView& view) { return view.points.size() + ReferenceLayer::kViewItself; }

} // namespace

ReferenceView reference_view_of(const RobotCapture& capture) {
    ReferenceView view{.from = capture.capture.from, .points = {}, .ended = capture.ended};
    const auto& points = capture.capture.points;
    const std::size_t step = (points.size() + ReferenceLayer::kPointsOfAView - 1) / ReferenceLayer::kPointsOfAView;
    for (std::size_t n = 0; n < points.size(); n += step) view.points.push_back(points[n]);
    return view;
}

void ReferenceLayer::add(const RobotCapture& ended) {
    const Capture& capture = ended.capture;
    if (capture.points.empty()) return;
    const double turns = normalize_angle(capture.pose.yaw) / (2.0 * std::numbers::pi) + 0.5;
    const PlaceKey key{static_cast<std::int64_t>(std::floor(capture.from.y / kPlaceSize)),
                       static_cast<std::int64_t>(std::floor(capture.from.x / kPlaceSize)),
                       static_cast<std::int64_t>(std::floor(turns * kDirections)) % kDirections};
    ReferenceViews& views = places_[key];
    views.push_back(std::make_shared<const ReferenceView>(reference_view_of(ended)));
    size_ += size_of(*views.back());
    if (views.size() <= kViewsOfAPlace) return;
    size_ -= size_of(*views.front());
    views.erase(views.begin());
}

ReferenceViews ReferenceLayer::snapshot() const {
    ReferenceViews all;
    for (const auto& [key, views] : places_) std::ranges::copy(views, std::back_inserter(all));
    std::ranges::stable_sort(all, {}, [](const auto& view) { return view->ended; });
    return all;
}

namespace {

constexpr double kBeenThere = 0.3; // metres from the place of a view

} // namespace

std::optional<Extent> extent_of(ReferenceViewSpan views) {
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    Point2 low{kInfinite, kInfinite};
    Point2 high{-kInfinite, -kInfinite};
    for (const auto& view : views) {
        for (const PointMm& point : view->points) {
            low = min_corner(low, in_metres(point));
            high = max_corner(high, in_metres(point));
        }
    }
    if (low.x > high.x) return std::nullopt; // no points
    return Extent{(low + high) / 2.0, 0.5 * max_abs(high - low)};
}

Result<ReferenceMap> ReferenceMap::of(ReferenceViewSpan views, const Point2& middle,
                                      const std::function<Result<>()>& ask) {
    ReferenceMap map(middle);
    std::vector<std::vector<Point2>> points; // by view
    map.horizons_.reserve(views.size());
    for (const auto& view : views) {
        if (auto go_on = ask(); !go_on) return go_on.error();
        auto& its = points.emplace_back();
        for (const PointMm& point : view->points) its.push_back(in_metres(point) - middle);
        map.horizons_.emplace_back(its, view->from - middle);
    }
    for (const Surfel& surfel : surfels_of(points)) {
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
        return squared_norm(surfel.position - place) <= radius * radius;
    });
    Seen seen{Surface(std::move(near)), {}};
    for (const Horizon& horizon : horizons_) {
        const double far = radius + horizon.reach();
        if (squared_norm(horizon.from() - place) < far * far) seen.horizons.push_back(&horizon);
    }
    return seen;
}

bool ReferenceMap::is_possible(const Point2& place) const {
    return std::ranges::any_of(horizons_, [&](const Horizon& horizon) {
        if (squared_norm(horizon.from() - place) < kBeenThere * kBeenThere) return true;
        return horizon.reaches(place) && horizon.at(place) != Horizon::Verdict::kHidden;
    });
}

} // namespace scanloom::landmarks
