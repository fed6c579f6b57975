#pragma once

#include "common/error/error.hpp"
#include "common/scan/poses.hpp"
#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace scanloom::bench {

/// The scans of one robot with one laser.
struct LaserDrive {
    Sensor laser;
    std::vector<Scan> scans; ///< with seqs from 1
};

/// Returns the laser scans of a CARMEN log.
/// @param poses  how its poses are used
/// @param most   scans
/// Errors: those of the log; kNotFound if it has no laser scans, kConflict if they are of several lasers.
[[nodiscard]] Result<LaserDrive> drive_of_log(const std::string& file, Poses poses, std::size_t most);

/// Returns the scans of a drive through the simulator's office, with noise and drifting odometry: 360 beams, 10 Hz.
/// @param poses     what the scans have
/// @param driving   scans while the robot drives
/// @param standing  further scans, with the same noise, while it stands at the end
[[nodiscard]] LaserDrive simulated_drive(Poses poses, std::size_t driving, std::size_t standing);

} // namespace scanloom::bench
