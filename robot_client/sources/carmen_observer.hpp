#pragma once

#include "common/error/error.hpp"
#include "common/scan/poses.hpp"
#include "robot_client/sources/carmen_line.hpp"
#include "robot_client/sources/line_reader.hpp"
#include "robot_client/sources/source.hpp"

#include <memory>
#include <optional>
#include <vector>

namespace scanloom::robot {

struct CarmenOptions {
    /// Default: kFree if the log states its sensor's range (ROBOTLASER, RAWLASER), kDrop if it does not (FLASER).
    std::optional<NoReturn> no_return;
    /// Metres. Readings of at least this length are no-returns, as are those of the length that the log states.
    /// Default: kCarmenRangeMax.
    std::optional<double> range_max;
    LineLimits limits;
    /// How the poses of the log are used. Unless they are kMap, FLASER lines need CarmenMounts::flaser.
    Poses poses = Poses::kMap;
};

/// Poses of lasers relative to their robot that a single line does not contain.
struct CarmenMounts {
    double raw_laser_forward = 0.0; ///< metres, of RAWLASER lines
    Pose2 flaser;                   ///< T_robot_laser of FLASER lines
};

/// Logs write "no return" as 50, 80, 81.83, 81.91 ...: readings from 50 m on are no-returns unless the user sets
/// another limit.
inline constexpr double kCarmenRangeMax = 50.0;

/// Returns how beams without a return are used in lines of this kind.
[[nodiscard]] NoReturn no_return_of(CarmenKind kind, const CarmenOptions& options);

/// Checks whether a line can become a scan, as far as the line alone shows.
/// Errors: kInvalidField if it states a range that no sensor has; kTooLarge if its laser is too far from its robot.
[[nodiscard]] Result<> check_usable(const CarmenScan& line, const CarmenOptions& options);

/// Converts the lines of one log into scans of described sensors. Call observe() in order of time.
class CarmenObserver {
public:
    CarmenObserver(const CarmenOptions& options, const CarmenMounts& mounts) : options_(options), mounts_(mounts) {}

    /// Converts one line. Pre: a RAWLASER line has the robot's pose filled in, unless poses are kNone; the line has a
    /// stamp.
    /// Errors: those of check_usable().
    [[nodiscard]] Result<Observation> observe(const CarmenScan& line);

private:
    [[nodiscard]] std::shared_ptr<const Sensor> sensor_like(const Sensor& wanted);

    CarmenOptions options_;
    CarmenMounts mounts_;
    std::vector<std::shared_ptr<const Sensor>> sensors_; ///< described so far, the newest last
};

} // namespace scanloom::robot
