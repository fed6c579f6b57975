#include "core/localization/mount_check.hpp"

#include "core/scan_matching/scan_points.hpp"

#include <fmt/format.h>

#include <cmath>

namespace scanloom::localization {
namespace {

constexpr double kLengthMin = 0.02;   // metres, of a motion that has a direction
constexpr double kLengthMax = 2.0;    // metres: odometry that moves by more has started again
constexpr double kTurnMax = 0.1;      // radians, of a straight motion
constexpr double kMemory = 20.0;      // metres
constexpr double kDistanceMin = 5.0;  // metres, before it decides
constexpr double kAgreementMin = 0.5; // of the lengths, by the scans in one direction
constexpr double kErrorMin = 0.26;    // radians: 15 degrees; skidding wheels deviate by less

} // namespace

Result<> check_mount(const Sensor& sensor) {
    const double distance = std::hypot(sensor.mount.x, sensor.mount.y);
    if (sensor.kind == SensorKind::kSonar || distance <= scan_matching::kMountDistanceMax) return {};
    return Error{Errc::kInvalidField,
                 fmt::format("mount is {:.1f} m from the robot's origin; poses are estimated with lasers within {} m "
                             "of it: give the mount in metres, in the robot frame",
                             distance, scan_matching::kMountDistanceMax)};
}

void MountCheck::add(const scan_matching::Transform2& by_odometry, const scan_matching::Transform2& by_scans) {
    const double length = distance_of(by_odometry);
    const double measured = distance_of(by_scans);
    if (!(length >= kLengthMin && length <= kLengthMax) || std::fabs(yaw_of(by_odometry)) > kTurnMax) return;
    if (!(measured <= 2.0 * length)) return; // a new place, not a motion
    const double kept = 1.0 - length / kMemory;
    along_ = kept * along_ + by_odometry.x * by_scans.x + by_odometry.y * by_scans.y;
    across_ = kept * across_ + by_odometry.x * by_scans.y - by_odometry.y * by_scans.x;
    travelled_ = kept * travelled_ + length * length;
    distance_ = kept * distance_ + length;
}

std::optional<double> MountCheck::yaw_error() const {
    if (distance_ < kDistanceMin || std::hypot(along_, across_) < kAgreementMin * travelled_) return std::nullopt;
    const double error = std::atan2(across_, along_);
    return std::fabs(error) >= kErrorMin ? std::optional(error) : std::nullopt;
}

} // namespace scanloom::localization
