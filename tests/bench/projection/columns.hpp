#pragma once

#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"

#include <string>
#include <vector>

namespace scanloom::bench {

/// The input of all mappers: scans of one sensor at known poses, and the cell size.
struct Column {
    std::string name; ///< e.g. "room/0.05"
    double cell_size; ///< metres
    Sensor sensor;    ///< on the robot's centre
    std::vector<Scan> scans;
    double half_side; ///< metres: the square from -half_side to half_side around the origin contains all observed cells
};

/// Returns rooms, offices and halls of the simulator, and real logs if they are on this machine. The scans are the same
/// each time.
[[nodiscard]] const std::vector<Column>& columns();

} // namespace scanloom::bench
