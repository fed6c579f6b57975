#pragma once

#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"
#include "common/wire/prepared_scan.hpp"
#include "load/core/schedule.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::load {

/// What all robots do: the scans they send, round and round, and when. Never changes while they run.
struct Course {
    std::vector<wire::PreparedScan> scans; ///< one way through the world, in the order of driving
    std::size_t beams = 0;                 ///< of a scan
    std::string sensor_frame;              ///< the description of what took them, as it travels
    std::optional<Schedule> schedule;      ///< absent: each scan as soon as the server's credit allows
    double stamp_rate = 10.0;              ///< scans a second, as their robot's clock has them
    std::uint32_t batch = 1;               ///< scans of a frame; a scan waits for the others of its frame
};

/// Prepares the scans of a sensor.
/// Pre  there are some; batch > 0; stamp_rate > 0
[[nodiscard]] Course make_course(const Sensor& sensor, const std::vector<Scan>& scans, double stamp_rate,
                                 std::uint32_t batch);

/// Scan `seq` of a robot that begins at scan `first` of the course: the same each time it is asked for.
[[nodiscard]] wire::NumberedScan scan_at(const Course& course, std::size_t first, std::uint64_t seq) noexcept;

} // namespace scanloom::load
