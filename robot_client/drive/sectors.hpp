#pragma once

#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"
#include "robot_client/drive/behaviour.hpp"

#include <vector>

namespace scanloom::robot {

/// The nearest valid reading of each sector, for a sensor that looks along its robot's axis.
/// Pre  the scan is one of the sensor's.
[[nodiscard]] SectorRanges sector_ranges(const Scan& scan, const Sensor& sensor);

/// Where the beams of a scan ended that had a return, metres in the map frame.
/// Pre  as above; the scan carries the robot's pose in the map frame.
[[nodiscard]] std::vector<Point2> obstacles_of(const Scan& scan, const Sensor& sensor);

} // namespace scanloom::robot
