#include "robot_client/sources/carmen_observer.hpp"

#include "common/scan/limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace scanloom::robot {
namespace {

/// Logs print poses with six decimals, so mounts derived from them agree to a few times that.
constexpr double kMountRounding = 1e-5;

/// Descriptions that are kept for reuse. A log whose mount changes from line to line is described again each time.
constexpr std::size_t kSensorsRemembered = 16;

bool nearly_same(const Pose2& a, const Pose2& b) {
    return std::abs(a.x - b.x) < kMountRounding && std::abs(a.y - b.y) < kMountRounding &&
           std::abs(normalize_angle(a.yaw - b.yaw)) < kMountRounding;
}

bool same_beams(const BeamAngles& a, const BeamAngles& b) {
    const auto& first = std::get<UniformAngles>(a);
    const auto& second = std::get<UniformAngles>(b);
    return first.first == second.first && first.increment == second.increment; // scans may differ in their beam count
}

Pose2 mount_of(const CarmenScan& line, const CarmenMounts& mounts) {
    if (line.kind == CarmenKind::kRawLaser) return {mounts.raw_laser_forward, 0.0, 0.0};
    if (line.kind == CarmenKind::kFlaser) return mounts.flaser;
    if (line.laser == line.robot) return {};
    return compose(inverse(line.robot), line.laser);
}

Result<double> range_max_of(const CarmenScan& line, const CarmenOptions& options) {
    const double believed = options.range_max.value_or(kCarmenRangeMax);
    if (line.kind == CarmenKind::kFlaser) return believed;
    if (line.range_max) return std::min(*line.range_max, believed);
    if (options.range_max) return believed;
    return Error{Errc::kInvalidField, "maximum_range is not a valid length; give --max-range"};
}

std::string name_for(const CarmenScan& line) { return line.sensor == 0 ? "front laser" : "rear laser"; }

/// Sets the pose and the odometry of a scan whose robot knows its pose in the map.
void set_map_pose(Scan& scan, const CarmenScan& line, const Pose2& mount) {
    switch (line.kind) {
    case CarmenKind::kFlaser:
        scan.pose = line.laser;
        scan.odometry = line.robot;
        break;
    case CarmenKind::kRobotLaser: scan.pose = compose(line.laser, inverse(mount)); break;
    case CarmenKind::kRawLaser: scan.pose = line.robot; break;
    }
}

} // namespace

NoReturn no_return_of(CarmenKind kind, const CarmenOptions& options) {
    return options.no_return.value_or(kind == CarmenKind::kFlaser ? NoReturn::kDrop : NoReturn::kFree);
}

Result<> check_usable(const CarmenScan& line, const CarmenOptions& options) {
    if (const auto range_max = range_max_of(line, options); !range_max) return range_max.error();
    const Pose2 mount = mount_of(line, {});
    if (std::max(std::abs(mount.x), std::abs(mount.y)) <= kCoordinateMax) return {};
    return Error{Errc::kTooLarge, fmt::format("the laser is more than {} m from its robot", kCoordinateMax)};
}

Result<Observation> CarmenObserver::observe(const CarmenScan& line) {
    if (auto ok = check_usable(line, options_); !ok) return ok.error();
    const double range_max = *range_max_of(line, options_);
    const Pose2 mount = mount_of(line, mounts_);
    Observation observation;
    observation.sensor =
        sensor_like({line.sensor, SensorKind::kLaser, name_for(line), mount, line.angles, 0.0, 0.0, range_max});

    Scan& scan = observation.scan;
    scan.stamp = *line.stamp;
    scan.sensor = line.sensor;
    scan.ranges = line.ranges;
    const RangeMm no_return = no_return_of(line.kind, options_) == NoReturn::kFree ? kNoReturn : kInvalidRange;
    const auto is_beyond = [&, max = to_range_mm(range_max)](RangeMm range) {
        return range != kInvalidRange && range >= max;
    };
    std::ranges::replace_if(scan.ranges, is_beyond, no_return);
    if (options_.poses == Poses::kMap) {
        set_map_pose(scan, line, observation.sensor->mount);
    } else {
        set_pose(scan, options_.poses, line.robot);
    }
    return observation;
}

std::shared_ptr<const Sensor> CarmenObserver::sensor_like(const Sensor& wanted) {
    const auto same = [&](const std::shared_ptr<const Sensor>& known) {
        return known->id == wanted.id && known->range_max == wanted.range_max &&
               nearly_same(known->mount, wanted.mount) && same_beams(known->angles, wanted.angles);
    };
    const auto known = std::find_if(sensors_.rbegin(), sensors_.rend(), same);
    if (known != sensors_.rend()) return *known;
    if (sensors_.size() == kSensorsRemembered) sensors_.erase(sensors_.begin());
    sensors_.push_back(std::make_shared<const Sensor>(wanted));
    return sensors_.back();
}

} // namespace scanloom::robot
