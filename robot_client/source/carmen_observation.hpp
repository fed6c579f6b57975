#pragma once

#include "common/error/error.hpp"
#include "robot_client/source/carmen_line.hpp"
#include "robot_client/source/carmen_log.hpp"
#include "robot_client/source/source.hpp"

#include <memory>
#include <vector>

namespace scanloom::robot {

/// Turns the lines of one log into scans of described sensors. Feed it in order of time.
class CarmenObserver {
public:
    CarmenObserver(const CarmenOptions& options, double laser_offset_forward)
        : options_(options), laser_offset_forward_(laser_offset_forward) {}

    /// Pre     a RAWLASER line comes with the robot's pose filled in; `stamp` is finite.
    /// Errors  kInvalidField: the line states a range no sensor has; kTooLarge: its laser is too far from its robot.
    [[nodiscard]] Result<Observation> observe(const CarmenScan& line, double stamp);

private:
    [[nodiscard]] Result<double> range_max_of(const CarmenScan& line) const;
    [[nodiscard]] std::vector<RangeMm> ranges_of(const CarmenScan& line, double range_max) const;
    [[nodiscard]] std::shared_ptr<const Sensor> sensor_like(const Sensor& wanted);

    CarmenOptions options_;
    double laser_offset_forward_;
    std::vector<std::shared_ptr<const Sensor>> sensors_; ///< described so far, the newest last
};

} // namespace scanloom::robot
