#pragma once

#include "common/error/error.hpp"
#include "common/scan/poses.hpp"
#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace scanloom::robot {

/// How a beam without a return is used: the cells up to range_max are free, or the beam is dropped.
enum class NoReturn { kFree, kDrop };

/// Sets the pose of the robot that took a scan, as a robot with such poses sends it: as Scan::pose, as Scan::odometry,
/// or not at all.
inline void set_pose(Scan& scan, Poses poses, const Pose2& pose) {
    if (poses == Poses::kMap) scan.pose = pose;
    if (poses == Poses::kOdometry) scan.odometry = pose;
}

/// Returns whether a robot with such poses may send the scan: kMap needs a pose, kOdometry an odometry and no pose,
/// kNone neither.
[[nodiscard]] inline bool agrees_with(const Scan& scan, Poses poses) {
    if (poses == Poses::kMap) return scan.pose.has_value();
    return !scan.pose && scan.odometry.has_value() == (poses == Poses::kOdometry);
}

/// A scan and the sensor that took it. The uplink sets its seq.
struct Observation {
    std::shared_ptr<const Sensor> sensor;
    Scan scan;
};

/// A source of scans, in the order in which they are sent.
///
/// Every scan and sensor keeps common/scan/limits.hpp, so the server accepts it.
/// Threads: one at a time.
class Source {
public:
    virtual ~Source() = default;

    /// Returns the next scan, or nullopt at the end. A source that is recreated gives the same scans again; so a robot
    /// can resume after the scans that the server has.
    /// Errors: those of a recording that cannot be read further.
    [[nodiscard]] virtual Result<std::optional<Observation>> next() = 0;

    /// Returns the total number of scans of this source, or nullopt if it is endless or the number is not known.
    [[nodiscard]] virtual std::optional<std::uint64_t> scan_count() const = 0;

    /// Returns a few words for people about the source, in addition to its scans; may be empty.
    [[nodiscard]] virtual std::string remarks() const { return {}; }
};

} // namespace scanloom::robot
