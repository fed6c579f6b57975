#include "robot_client/lidars/lidar_scan.hpp"

#include "common/scan/limits.hpp"
#include "robot_client/sources/stationary_detector.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <utility>

namespace scanloom::robot {

RangeFilter::RangeFilter(const LidarScanOptions& options)
    : min_(to_range_mm(options.range_min)), max_(to_range_mm(options.range_max)),
      no_return_(options.no_return == NoReturn::kFree ? kNoReturn : kInvalidRange) {}

std::shared_ptr<const Sensor> lidar_sensor(std::string_view name, std::uint32_t usual_beams,
                                           const LidarScanOptions& options) {
    const UniformAngles angles{0.0, 2.0 * std::numbers::pi / usual_beams, usual_beams};
    return std::make_shared<const Sensor>(Sensor{.id = 0,
                                                 .kind = SensorKind::kLaser,
                                                 .name = std::string(name),
                                                 .mount = options.mount,
                                                 .angles = angles,
                                                 .aperture = 0.0,
                                                 .range_min = options.range_min,
                                                 .range_max = options.range_max});
}

Scan lidar_scan(const LidarTurn& turn, std::int32_t steps_per_turn, const LidarScanOptions& options) {
    const RangeFilter filter(options);
    Scan scan;
    scan.stamp = turn.stamp;
    // The sensor turns clockwise, so the first beam was taken last.
    if (std::abs(turn.duration) <= kDurationMax) scan.duration = 0.0 - turn.duration;
    SteppedAngles angles{2.0 * std::numbers::pi / steps_per_turn, {}};
    for (auto beam = turn.beams.rbegin(); beam != turn.beams.rend(); ++beam) {
        const auto& [distance, confidence] = beam->point;
        angles.steps.push_back(steps_per_turn - beam->step);
        scan.ranges.push_back(confidence < options.confidence_min ? kInvalidRange : filter(distance));
        scan.intensities.push_back(confidence);
    }
    if (options.median_window) {
        scan.ranges = median_filtered(scan.ranges, angles.steps, steps_per_turn, *options.median_window);
    }
    scan.angles = std::move(angles);
    return scan;
}

} // namespace scanloom::robot
