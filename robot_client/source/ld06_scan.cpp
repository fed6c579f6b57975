#include "robot_client/source/ld06_scan.hpp"

#include "robot_client/source/range_median.hpp"

#include <numbers>

namespace scanloom::robot {
namespace {

constexpr double kRadiansPerStep = 2.0 * std::numbers::pi / kLd06StepsPerTurn;

/// Only for the description: every scan contains its own angles.
constexpr std::uint32_t kUsualBeams = 450;

class ReadingFilter {
public:
    explicit ReadingFilter(const Ld06ScanOptions& options)
        : confidence_min_(options.confidence_min), min_(to_range_mm(options.range_min)),
          max_(to_range_mm(options.range_max)),
          no_return_(options.no_return == NoReturn::kFree ? kNoReturn : kInvalidRange) {}

    [[nodiscard]] RangeMm operator()(const Ld06Point& point) const {
        static_assert(kInvalidRange == 0, "a distance of 0 is none, whatever the least range is");
        if (point.distance < min_ || point.confidence < confidence_min_) return kInvalidRange;
        return point.distance < max_ ? point.distance : no_return_;
    }

private:
    std::uint8_t confidence_min_;
    RangeMm min_;
    RangeMm max_;
    RangeMm no_return_;
};

} // namespace

std::shared_ptr<const Sensor> ld06_sensor(const Ld06ScanOptions& options) {
    const UniformAngles angles{0.0, 2.0 * std::numbers::pi / kUsualBeams, kUsualBeams};
    return std::make_shared<const Sensor>(Sensor{.id = 0,
                                                 .kind = SensorKind::kLaser,
                                                 .name = "LD06",
                                                 .mount = options.mount,
                                                 .angles = angles,
                                                 .aperture = 0.0,
                                                 .range_min = options.range_min,
                                                 .range_max = options.range_max});
}

Scan ld06_scan(const Ld06Turn& turn, const Ld06ScanOptions& options) {
    const ReadingFilter filter(options);
    Scan scan;
    scan.stamp = turn.stamp;
    SteppedAngles angles{kRadiansPerStep, {}};
    for (auto beam = turn.beams.rbegin(); beam != turn.beams.rend(); ++beam) {
        angles.steps.push_back(kLd06StepsPerTurn - beam->step);
        scan.ranges.push_back(filter(beam->point));
        scan.intensities.push_back(beam->point.confidence);
    }
    if (options.median_window) {
        scan.ranges = median_filtered(scan.ranges, angles.steps, kLd06StepsPerTurn, *options.median_window);
    }
    scan.angles = std::move(angles);
    return scan;
}

} // namespace scanloom::robot
