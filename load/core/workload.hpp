#pragma once

#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"
#include "common/wire/prepared_scan.hpp"
#include "load/core/micros.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace scanloom::load {

/// The intended sending time of each scan of each robot, independent of the server: a robot sends one scan per period,
/// and the robots are spread evenly over the period. The scans of all robots thus form one steady sequence: first robot
/// 0, then robot 1, ..., then robot 0 again.
///
/// Latency is measured from these times, not from the moment when the link had room again: a load tool that sends late
/// because the server is slow would otherwise omit exactly the long latencies ("coordinated omission").
/// Threads: any.
class Schedule {
public:
    Schedule() = default;
    /// @param rate  scans per second of each robot
    /// Pre: robots > 0, rate > 0.
    Schedule(std::uint32_t robots, double rate);

    /// Position of a robot's scan `seq` (from 1) in the sequence of all robots' scans, from 0.
    [[nodiscard]] std::uint64_t place_of(std::uint32_t robot, std::uint64_t seq) const noexcept {
        return (seq - 1) * robots_ + robot;
    }
    [[nodiscard]] std::uint32_t robot_at(std::uint64_t place) const noexcept {
        return static_cast<std::uint32_t>(place % robots_);
    }
    [[nodiscard]] std::uint64_t seq_at(std::uint64_t place) const noexcept { return place / robots_ + 1; }

    /// Time since the start, rounded down.
    [[nodiscard]] Micros due(std::uint64_t place) const noexcept {
        return static_cast<Micros>(static_cast<double>(place) * step_);
    }
    [[nodiscard]] Micros due(std::uint32_t robot, std::uint64_t seq) const noexcept {
        return due(place_of(robot, seq));
    }

    /// Returns how many scans of each robot are due before `duration` of its own time has passed: at least 1.
    [[nodiscard]] static std::uint64_t scans_within(double duration_s, double rate) noexcept;

private:
    std::uint64_t robots_ = 1;
    double step_ = 0.0; // microseconds from one scan of the sequence to the next
};

/// What all robots do: which scans they send, and when. Constant during a run.
struct Workload {
    std::vector<wire::PreparedScan>
        scans;             ///< one drive through the world; robots go to its end and back, again and again
    std::size_t beams = 0; ///< per scan
    std::shared_ptr<const Sensor> sensor;
    std::optional<Schedule> schedule; ///< absent: each scan as soon as the server's credit allows
    double stamp_rate = 10.0;         ///< scans per second by the robots' own clocks
    std::uint32_t batch = 1;          ///< scans per frame; a scan waits until its frame is full
};

/// Prepares the scans of a sensor.
/// Pre: `scans` is not empty; batch > 0; stamp_rate > 0.
[[nodiscard]] Workload make_workload(const Sensor& sensor, const std::vector<Scan>& scans, double stamp_rate,
                                     std::uint32_t batch);

/// Returns scan `seq` of a robot that starts at scan `first` of the workload, goes to its end, and then back and forth.
/// So no robot jumps, which the estimation of poses would take for a robot that is lost. The result is the same at each
/// call.
[[nodiscard]] wire::NumberedScan scan_at(const Workload& workload, std::size_t first, std::uint64_t seq) noexcept;

} // namespace scanloom::load
