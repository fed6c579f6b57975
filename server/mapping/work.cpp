#include "server/mapping/work.hpp"

#include <algorithm>
#include <numbers>

namespace scanloom::mapping {
namespace {

constexpr double kWorkPerSonarCell = 32.0; // two roots and an arc tangent

} // namespace

double reached(RangeMm range, const ModelGeometry& geometry) noexcept {
    const auto reading = reading_of(range, geometry.readings);
    if (!reading) return 0.0;
    return reading->is_hit ? std::min(geometry.readings.range_max, reading->metres + geometry.half_band())
                           : reading->metres;
}

double work_of_beam(const Reading& reading, const RayGeometry& geometry) noexcept {
    const double cells = reading.metres / geometry.cell_size;
    const double disc = geometry.hit_radius / geometry.cell_size;
    return 2.0 * cells + std::numbers::pi * disc * disc + 2.0;
}

double work_of_cone(double aperture, RangeMm range, const ModelGeometry& geometry) noexcept {
    const double cells = reached(range, geometry) / geometry.cell_size;
    return kWorkPerSonarCell * 0.5 * aperture * cells * cells + 2.0 * cells + 1.0;
}

} // namespace scanloom::mapping
