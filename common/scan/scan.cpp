#include "common/scan/scan.hpp"

#include <cmath>

namespace scanloom {

RangeMm to_range_mm(double range_m) noexcept {
    if (!(range_m > 0.0)) return kInvalidRange;
    const double mm = std::round(range_m * 1000.0);
    return mm < static_cast<double>(kNoReturn) ? static_cast<RangeMm>(mm) : kNoReturn;
}

BeamAngles angles_of(const Scan& scan, const Sensor& sensor) {
    if (scan.angles) return *scan.angles;
    if (const auto* uniform = std::get_if<UniformAngles>(&sensor.angles)) {
        return UniformAngles{uniform->first, uniform->increment, static_cast<std::uint32_t>(scan.ranges.size())};
    }
    return sensor.angles;
}

} // namespace scanloom
