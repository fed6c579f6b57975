#pragma once

#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"
#include "robot_client/drive/behaviour.hpp"

namespace scanloom::robot {

/// The nearest valid reading of each sector, for a sensor that looks along its robot's axis.
/// Pre  the scan is one of the sensor's.
[[nodiscard]] SectorRanges sector_ranges(const Scan& scan, const Sensor& sensor);

} // namespace scanloom::robot
