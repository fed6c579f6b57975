#pragma once

#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"

#include <string>
#include <vector>

namespace scanloom::bench {

/// What every mapper is measured on: scans of one sensor at known poses, and the size of the cells.
struct Column {
    std::string name; ///< e.g. "room/0.05"
    double cell_size; ///< metres
    Sensor sensor;    ///< on the robot's centre
    std::vector<Scan> scans;
    double half_side; ///< metres: a square of so much around the origin holds all that the scans see
};

/// Rooms, offices and halls of the simulator, and real logs where they are on this machine. The same scans each time.
[[nodiscard]] const std::vector<Column>& columns();

} // namespace scanloom::bench
