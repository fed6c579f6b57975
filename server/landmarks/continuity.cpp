#include "server/landmarks/continuity.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace scanloom::landmarks {
namespace {

struct Axes {
    double major = 0.0; ///< eigenvalues, square metres
    double minor = 0.0;
    Point2 direction{1.0, 0.0}; ///< of the major axis
};

/// Computes the axes of points. Coordinates are relative to the first point, so that equal points have exactly no
/// extent.
Axes axes_of(std::span<const Point2> points) {
    const auto count = static_cast<double>(points.size());
    Point2 mean{0.0, 0.0};
    for (const Point2& point : points) mean += (point - points.front()) / count;
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;
    for (const Point2& point : points) {
        const Point2 off = point - points.front() - mean;
        xx += off.x * off.x / count;
        xy += off.x * off.y / count;
        yy += off.y * off.y / count;
    }
    const double middle = 0.5 * (xx + yy);
    const double apart = std::hypot(0.5 * (xx - yy), xy);
    Axes axes{middle + apart, std::max(middle - apart, 0.0)};
    // Of the two forms of the eigenvector, the one without cancellation.
    const Point2 direction = xx >= yy ? Point2{axes.major - yy, xy} : Point2{xy, axes.major - xx};
    if (norm(direction) > 0.0) axes.direction = normalized(direction);
    return axes;
}

std::vector<double> gaps_along(std::span<const Point2> points, const Point2& direction) {
    std::vector<double> places(points.size());
    std::ranges::transform(points, places.begin(),
                           [&](const Point2& point) { return dot(point - points.front(), direction); });
    std::ranges::sort(places);
    std::vector<double> gaps(places.size() - 1);
    for (std::size_t n = 0; n < gaps.size(); ++n) gaps[n] = places[n + 1] - places[n];
    return gaps;
}

/// Returns the evenness of gaps; see Continuity.
/// Precondition: mean > 0.
double evenness_of(std::span<const double> gaps, double mean) {
    double variance = 0.0;
    for (const double gap : gaps) variance += (gap - mean) * (gap - mean) / static_cast<double>(gaps.size());
    return 1.0 / (1.0 + std::sqrt(variance) / mean);
}

} // namespace

Continuity continuity_of(std::span<const Point2> points, double eps) {
    if (points.size() < 2) return {};
    const Axes axes = axes_of(points);
    if (!(axes.major > 0.0)) return {};
    const std::vector<double> gaps = gaps_along(points, axes.direction);
    double extent = 0.0;
    double filled = 0.0;
    for (const double gap : gaps) {
        extent += gap;
        if (gap < 2.0 * eps) filled += gap;
    }
    if (!(extent > 0.0)) return {};
    return {1.0 - axes.minor / axes.major, evenness_of(gaps, extent / static_cast<double>(gaps.size())),
            filled / extent};
}

} // namespace scanloom::landmarks
