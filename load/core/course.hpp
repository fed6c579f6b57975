#pragma once

#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"
#include "common/wire/prepared_scan.hpp"
#include "load/core/schedule.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace scanloom::load {

/// What all robots do: which scans they send, again and again, and when. Constant during a run.
struct Course {
    std::vector<wire::PreparedScan> scans; ///< one tour through the world, in driving order
    std::size_t beams = 0;                 ///< per scan
    std::shared_ptr<const Sensor> sensor;
    std::optional<Schedule> schedule; ///< absent: each scan as soon as the server's credit allows
    double stamp_rate = 10.0;         ///< scans per second by the robots' own clocks
    std::uint32_t batch = 1;          ///< scans per frame; a scan waits until its frame is full
};

/// Prepares the scans of a sensor.
/// Pre: `scans` is not empty; batch > 0; stamp_rate > 0.
[[nodiscard]] Course make_course(const Sensor& sensor, const std::vector<Scan>& scans, double stamp_rate,
                                 std::uint32_t batch);

/// Returns scan `seq` of a robot that starts at scan `first` of the course. The result is the same at each call.
[[nodiscard]] wire::NumberedScan scan_at(const Course& course, std::size_t first, std::uint64_t seq) noexcept;

} // namespace scanloom::load
