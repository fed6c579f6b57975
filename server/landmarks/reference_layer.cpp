#include "server/landmarks/reference_layer.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
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

} // namespace scanloom::landmarks
