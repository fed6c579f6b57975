#include "core/landmarks/filter_figures.hpp"

#include "common/geometry/pose2.hpp"
#include "core/landmarks/points.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace scanloom::landmarks {
namespace {

using Points = std::vector<std::optional<Point2>>;

/// Returns one point for each beam, in the sensor frame; nullopt if the beam has no return.
Points points_of(std::span<const RangeMm> ranges, const BeamAngles& angles) {
    Points points(ranges.size());
    for (std::size_t n = 0; n < ranges.size(); ++n) {
        if (ranges[n] == kInvalidRange || ranges[n] == kNoReturn) continue;
        const double range = 1e-3 * ranges[n];
        const double angle = beam_angle(angles, n);
        points[n] = Point2{range * std::cos(angle), range * std::sin(angle)};
    }
    return points;
}

double rmse(const Points& before, const Points& after) {
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t n = 0; n < before.size(); ++n) {
        assert(before[n].has_value() == after[n].has_value());
        if (!before[n]) continue;
        sum += squared_norm(*after[n] - *before[n]);
        ++count;
    }
    return count == 0 ? 0.0 : std::sqrt(sum / static_cast<double>(count));
}

/// Returns the roughness along each axis.
Point2 roughness(const Points& points, bool full_circle) {
    std::vector<double> x;
    std::vector<double> y;
    const std::size_t count = points.size();
    for (std::size_t n = 0; n + (full_circle ? 0 : 2) < count; ++n) {
        const auto& a = points[n];
        const auto& b = points[(n + 1) % count];
        const auto& c = points[(n + 2) % count];
        if (!a || !b || !c) continue;
        const Point2 bend = *a - 2.0 * *b + *c;
        x.push_back(std::abs(bend.x));
        y.push_back(std::abs(bend.y));
    }
    if (x.empty()) return {0.0, 0.0};
    return {median(x), median(y)};
}

std::optional<double> reduction(double before, double after) {
    if (!(before > 0.0)) return std::nullopt;
    return 1.0 - after / before;
}

} // namespace

FilterFigures filter_figures(std::span<const RangeMm> before, std::span<const RangeMm> after,
                             const BeamAngles& angles) {
    assert(before.size() == after.size() && before.size() == beam_count(angles));
    const Points points_before = points_of(before, angles);
    const Points points_after = points_of(after, angles);
    const bool full_circle = is_full_circle(angles);
    const Point2 rough_before = roughness(points_before, full_circle);
    const Point2 rough_after = roughness(points_after, full_circle);
    return {rmse(points_before, points_after), reduction(rough_before.x, rough_after.x),
            reduction(rough_before.y, rough_after.y)};
}

bool is_full_circle(const BeamAngles& angles) {
    const std::size_t beams = beam_count(angles);
    if (beams < 3) return false;
    const double span = std::abs(beam_angle(angles, beams - 1) - beam_angle(angles, 0));
    const double step = span / static_cast<double>(beams - 1);
    return 2.0 * std::numbers::pi - span <= 2.5 * step;
}

} // namespace scanloom::landmarks
