#pragma once

#include "robot_client/ros/scan_place.hpp"
#include "robot_client/sources/source.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace scanloom::robot {

/// Makes observations of laser scans. Scans whose sensors agree share one description.
/// Threads: one at a time.
class ScanObserver {
public:
    /// Returns the observation of a scan.
    /// @param recorded  when the message was recorded or received
    /// @param id        of the sensor
    /// @param topic     its name
    /// @param meaning   of its readings
    /// @param place     where the scan was taken
    /// @param poses     what the poses are
    /// Precondition: the scan is usable.
    [[nodiscard]] Observation observe(const RosLaserScan& message, RosTime recorded, std::uint32_t id,
                                      const std::string& topic, const RangeMeaning& meaning, const ScanPlace& place,
                                      Poses poses);

private:
    [[nodiscard]] std::shared_ptr<const Sensor> sensor_like(Sensor wanted);

    std::vector<std::shared_ptr<const Sensor>> sensors_; // the newest ones
};

} // namespace scanloom::robot
