#include "core/scan_matching/seen_space.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scanloom::scan_matching {
namespace {

constexpr double kSurface = 0.15;  // metres before a point that are not free
constexpr double kStep = 0.08;     // metres along a beam
constexpr double kBeforeEnd = 0.3; // metres: see meets_point()
constexpr double kMargin = 0.3;    // metres around all points

} // namespace

SeenSpace::SeenSpace(std::span<const View> views) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    double right = -kInfinity;
    double top = -kInfinity;
    x_ = kInfinity;
    y_ = kInfinity;
    const auto include = [&](double x, double y) {
        x_ = std::min(x_, x);
        y_ = std::min(y_, y);
        right = std::max(right, x);
        top = std::max(top, y);
    };
    for (const View& view : views) {
        const Point2 laser = view.T_map_robot * view.laser;
        if (!view.points.empty()) include(laser.x, laser.y);
        for (const SurfacePoint& point : view.points) {
            const Point2 at = view.T_map_robot * Point2{point.x, point.y};
            include(at.x, at.y);
        }
    }
    if (right < x_) {
        x_ = y_ = 0.0;
        return;
    }
    x_ -= kMargin;
    y_ -= kMargin;
    width_ = static_cast<std::int64_t>((right - x_ + kMargin) / kCell) + 1;
    height_ = static_cast<std::int64_t>((top - y_ + kMargin) / kCell) + 1;
    cells_.assign(static_cast<std::size_t>(width_ * height_), 0);
    for (const View& view : views) draw_beams(view);
    for (const View& view : views) {
        for (const SurfacePoint& point : view.points) {
            const Point2 end = view.T_map_robot * Point2{point.x, point.y};
            const auto column = static_cast<std::int64_t>((end.x - x_) * (1.0 / kCell));
            const auto row = static_cast<std::int64_t>((end.y - y_) * (1.0 / kCell));
            std::uint8_t* cell = cells_.data() + row * width_ + column;
            *cell |= kPoint;
            for (std::int64_t j = -1; j <= 1; ++j) {
                for (std::int64_t i = -1; i <= 1; ++i) cell[j * width_ + i] |= kNearPoint;
            }
        }
    }
}

bool SeenSpace::meets_point(const Point2& laser, const Point2& end) const noexcept {
    const double dx = laser.x - end.x;
    const double dy = laser.y - end.y;
    const double length = std::sqrt(dx * dx + dy * dy);
    for (double at = kBeforeEnd; at < length; at += kStep) {
        if (has_point(end.x + at / length * dx, end.y + at / length * dy)) return true;
    }
    return false;
}

void SeenSpace::draw_beams(const View& view) {
    const Point2 start = view.T_map_robot * view.laser;
    for (const SurfacePoint& point : view.points) {
        const Point2 end = view.T_map_robot * Point2{point.x, point.y};
        const double dx = end.x - start.x;
        const double dy = end.y - start.y;
        const double length = std::sqrt(dx * dx + dy * dy);
        const auto steps = static_cast<int>((length - kSurface) / kStep);
        for (int n = 0; n < steps; ++n) {
            const double part = (n + 0.5) * kStep / length;
            const auto column = static_cast<std::int64_t>((start.x + part * dx - x_) * (1.0 / kCell));
            const auto row = static_cast<std::int64_t>((start.y + part * dy - y_) * (1.0 / kCell));
            cells_[static_cast<std::size_t>(row * width_ + column)] |= kPassed;
        }
    }
}

} // namespace scanloom::scan_matching
