#pragma once

#include "common/error/error.hpp"
#include "robot_client/source/carmen_line.hpp"
#include "robot_client/source/line_reader.hpp"
#include "robot_client/source/source.hpp"

#include <memory>
#include <vector>

namespace scanloom::robot {

struct CarmenOptions {
    /// Default: kFree where the log states its sensor's range (ROBOTLASER, RAWLASER), kDrop where it does not (FLASER).
    std::optional<NoReturn> no_return;
    /// Metres; readings of this length or more are no-return, and so are those of the length that the log states.
    /// Default: kCarmenRangeMax.
    std::optional<double> range_max;
    LineLimits limits;
};

/// Logs write "no return" as 50, 80, 81.83, 81.91 ...: from 50 m on a reading is one, unless the user says otherwise.
inline constexpr double kCarmenRangeMax = 50.0;

/// What beams without a return mean in lines of this kind.
[[nodiscard]] NoReturn no_return_of(CarmenKind kind, const CarmenOptions& options);

/// Whether a line can become a scan, as far as it alone can tell.
/// Errors  kInvalidField: it states a range no sensor has; kTooLarge: its laser is too far from its robot.
[[nodiscard]] Result<> check_usable(const CarmenScan& line, const CarmenOptions& options);

/// Turns the lines of one log into scans of described sensors. Feed it in order of time.
class CarmenObserver {
public:
    CarmenObserver(const CarmenOptions& options, double laser_offset_forward)
        : options_(options), laser_offset_forward_(laser_offset_forward) {}

    /// Pre     a RAWLASER line comes with the robot's pose filled in; `stamp` is finite.
    /// Errors  those of check_usable().
    [[nodiscard]] Result<Observation> observe(const CarmenScan& line, double stamp);

private:
    [[nodiscard]] std::vector<RangeMm> ranges_of(const CarmenScan& line, double range_max) const;
    [[nodiscard]] std::shared_ptr<const Sensor> sensor_like(const Sensor& wanted);

    CarmenOptions options_;
    double laser_offset_forward_;
    std::vector<std::shared_ptr<const Sensor>> sensors_; ///< described so far, the newest last
};

} // namespace scanloom::robot
