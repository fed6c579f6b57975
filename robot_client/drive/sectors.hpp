#pragma once

#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"
#include "robot_client/drive/behaviour.hpp"

#include <vector>

namespace scanloom::robot {

/// Returns the nearest valid reading of each sector, for a sensor aligned with its robot's axis.
/// Pre: the sensor took the scan.
[[nodiscard]] SectorRanges sector_ranges(const Scan& scan, const Sensor& sensor);

/// Returns the end points of a scan's returns, in metres in the map frame.
/// Pre: the sensor took the scan; the scan contains the robot's pose in the map frame.
[[nodiscard]] std::vector<Point2> obstacles_of(const Scan& scan, const Sensor& sensor);

} // namespace scanloom::robot
