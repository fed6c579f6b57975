#include "server/live/core/scan_points.hpp"

#include "common/scan/beam_angles.hpp"
#include "common/scan/reading.hpp"

#include <cmath>

namespace scanloom::live {

wire::ScanPoints points_of(const mapping::FoldedScan& folded, std::size_t stride) {
    const Scan& scan = folded.scan;
    const Sensor& sensor = *folded.sensor;
    wire::ScanPoints out{sensor.id, sensor.kind, scan.stamp, compose(scan.pose, sensor.mount), {}};
    const BeamAngles angles = angles_of(scan, sensor);
    const ReadingRules rules{sensor.range_min, sensor.range_max, false};
    std::size_t hits = 0;
    for (std::size_t beam = 0; beam < scan.ranges.size(); ++beam) {
        const auto reading = reading_of(scan.ranges[beam], rules);
        if (!reading || !reading->is_hit || hits++ % stride != 0) continue;
        const double direction = out.origin.yaw + beam_angle(angles, beam);
        out.points.push_back(in_millimetres(reading->metres * Point2{std::cos(direction), std::sin(direction)}));
    }
    return out;
}

} // namespace scanloom::live
