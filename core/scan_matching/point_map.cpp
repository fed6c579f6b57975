#include "core/scan_matching/point_map.hpp"

#include "core/scan_matching/square_set.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace scanloom::scan_matching {
namespace {

constexpr float kSameSide = 0.5F; // cosine of the largest angle between normals of one surface

std::vector<SurfacePoint> thinned(std::span<const View> views) {
    std::size_t count = 0;
    for (const View& view : views) count += view.points.size();
    SquareSet taken(PointMap::kThinning, count);
    std::vector<SurfacePoint> points;
    points.reserve(count);
    for (const View& view : views) {
        for (const SurfacePoint& point : view.points) {
            const SurfacePoint moved = transform(view.T_map_robot, point);
            if (taken.insert(moved.x, moved.y)) points.push_back(moved);
        }
    }
    return points;
}

} // namespace

SurfacePoint transform(const Transform2& T_a_b, const SurfacePoint& point) noexcept {
    const auto [s, c] = T_a_b.rotation;
    const double x = point.x;
    const double y = point.y;
    const double normal_x = point.normal_x;
    const double normal_y = point.normal_y;
    return {float(T_a_b.x + c * x - s * y), float(T_a_b.y + s * x + c * y), float(c * normal_x - s * normal_y),
            float(s * normal_x + c * normal_y)};
}

PointMap::PointMap(std::span<const View> views) {
    const std::vector<SurfacePoint> points = thinned(views);
    if (points.empty()) return;
    const auto [left, right] = std::ranges::minmax(points, {}, &SurfacePoint::x);
    const auto [low, high] = std::ranges::minmax(points, {}, &SurfacePoint::y);
    x_ = left.x - 0.01F;
    y_ = low.y - 0.01F;
    constexpr auto kSide = static_cast<float>(kCell);
    width_ = static_cast<std::int32_t>((right.x - x_) / kSide) + 1;
    height_ = static_cast<std::int32_t>((high.y - y_) / kSide) + 1;
    const auto square_of = [&](const SurfacePoint& point) {
        return static_cast<std::size_t>(static_cast<std::int32_t>((point.y - y_) / kSide)) * std::size_t(width_) +
               static_cast<std::size_t>((point.x - x_) / kSide);
    };
    first_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) + 1, 0);
    for (const SurfacePoint& point : points) ++first_[square_of(point) + 1];
    for (std::size_t n = 1; n < first_.size(); ++n) first_[n] += first_[n - 1];
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    points_.resize(points.size());
    for (const SurfacePoint& point : points) points_[next[square_of(point)]++] = point;
}

PointMap::Neighbor PointMap::nearest(const SurfacePoint& point, float distance) const noexcept {
    constexpr auto kSide = static_cast<float>(kCell);
    Neighbor found{nullptr, distance * distance};
    const auto search = [&](std::int32_t column, std::int32_t row, std::int32_t rings) {
        const std::int32_t begin = std::max(0, column - rings);
        const std::int32_t end = std::min(width_, column + rings + 1);
        if (begin >= end) return;
        for (std::int32_t j = std::max(0, row - rings); j < std::min(height_, row + rings + 1); ++j) {
            const std::uint32_t* squares = first_.data() + std::ptrdiff_t{j} * width_;
            const SurfacePoint* last = points_.data() + squares[end];
            for (const SurfacePoint* other = points_.data() + squares[begin]; other != last; ++other) {
                const float dx = other->x - point.x;
                const float dy = other->y - point.y;
                const float squared = dx * dx + dy * dy;
                if (squared >= found.squared_distance) continue;
                const float cosine = other->normal_x * point.normal_x + other->normal_y * point.normal_y;
                if (cosine < kSameSide && other->has_normal() && point.has_normal()) continue;
                found = {other, squared};
            }
        }
    };
    const auto column = static_cast<std::int32_t>(std::floor((point.x - x_) / kSide));
    const auto row = static_cast<std::int32_t>(std::floor((point.y - y_) / kSide));
    search(column, row, 1);
    // The squares around contain every point within one side.
    const auto rings = static_cast<std::int32_t>(std::ceil(distance / kSide));
    if (rings > 1 && found.squared_distance > kSide * kSide) search(column, row, rings);
    return found;
}

} // namespace scanloom::scan_matching
