#include "core/slam/evidence.hpp"

#include "core/scan_matching/line_matching.hpp"
#include "core/scan_matching/square_set.hpp"

#include <cmath>
#include <utility>

namespace scanloom::slam {
namespace {

/// Returns whether a beam passes a surface of the map, apart from its first 30 and its last 40 cm.
bool passes_surface(const scan_matching::SeenSpace& space, const Point2& start, const Point2& end) {
    const double dx = end.x - start.x;
    const double dy = end.y - start.y;
    const double length = std::sqrt(dx * dx + dy * dy);
    for (double at = 0.3; at < length - 0.4; at += scan_matching::SeenSpace::kCell) {
        if (space.has_point(start.x + dx * at / length, start.y + dy * at / length)) return true;
    }
    return false;
}

} // namespace

void Evidence::add(KeyframeMap& map, const Transform2& pose, const Point2& laser,
                   const scan_matching::SurfacePoint& point) {
    const scan_matching::SurfacePoint moved = transform(pose, point);
    if (map.points().nearest(moved, scan_matching::kInlierDistance).point != nullptr) {
        matched += kSquare;
    } else if (map.space().is_free(moved.x, moved.y) || passes_surface(map.space(), pose * laser, {moved.x, moved.y})) {
        contradicted += kSquare;
    }
}

double contradictions_between(const KeyframeGraph& graph, std::span<const std::size_t> keyframes) {
    if (keyframes.empty()) return 0.0;
    const Transform2& first = graph.pose(keyframes.front());
    KeyframeViews views({first.x, first.y}, 2.0 * kMapRadius);
    std::size_t count = 0;
    for (std::size_t n = 0; n < keyframes.size(); ++n) {
        const Keyframe& keyframe = graph[keyframes[n]];
        if (n % 2 == 0) views.add(keyframe, graph.pose(keyframes[n]));
        count += keyframe.scan->points.size();
    }
    KeyframeMap map(std::move(views));
    scan_matching::SquareSet taken(Evidence::kSquare, count);
    Evidence evidence;
    for (std::size_t n = 1; n < keyframes.size(); n += 2) {
        const Keyframe& keyframe = graph[keyframes[n]];
        const Transform2& pose = graph.pose(keyframes[n]);
        for (const auto& point : keyframe.scan->points) {
            const Point2 at = pose * Point2{point.x, point.y};
            if (taken.insert(at.x, at.y)) evidence.add(map, pose, keyframe.scan->laser, point);
        }
    }
    return evidence.share();
}

} // namespace scanloom::slam
