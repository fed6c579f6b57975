#include "common/scan/scan.hpp"

#include <cmath>

namespace scanloom {

RangeMm to_range_mm(double range_m) noexcept {
    if (!(range_m > 0.0)) return kInvalidRange;
    const double mm = std::round(range_m * 1000.0);
    return mm < static_cast<double>(kNoReturn) ? static_cast<RangeMm>(mm) : kNoReturn;
}

namespace {

template <class Metres>
std::vector<RangeMm> each_to_mm(std::span<const Metres> ranges_m) {
    std::vector<RangeMm> ranges;
    ranges.reserve(ranges_m.size());
    for (const Metres range_m : ranges_m) ranges.push_back(to_range_mm(double{range_m}));
    return ranges;
}

} // namespace

std::vector<RangeMm> to_ranges_mm(std::span<const float> ranges_m) { return each_to_mm(ranges_m); }
std::vector<RangeMm> to_ranges_mm(std::span<const double> ranges_m) { return each_to_mm(ranges_m); }

BeamAngles angles_of(const Scan& scan, const Sensor& sensor) {
    if (scan.angles) return *scan.angles;
    if (const auto* uniform = std::get_if<UniformAngles>(&sensor.angles)) {
        return UniformAngles{uniform->first, uniform->increment, static_cast<std::uint32_t>(scan.ranges.size())};
    }
    return sensor.angles;
}

} // namespace scanloom
