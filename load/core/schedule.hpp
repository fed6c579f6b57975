#pragma once

#include "load/core/micros.hpp"

#include <cstdint>

namespace scanloom::load {

/// When each scan of each robot is meant to be sent, whatever the server does: scan n + 1 of a robot one period after
/// scan n, the robots spread evenly over the period. So the scans of all robots form one steady sequence: robot 0 the
/// first, robot 1 the second, ..., robot 0 again.
///
/// What a server keeps waiting is measured from here, not from the moment when the link had room again: a load tool
/// that sends late because the server is slow would otherwise leave out the very times that are long ("coordinated
/// omission").
/// Thread  any.
class Schedule {
public:
    Schedule() = default;
    /// Pre  robots > 0, rate > 0: scans a second of each robot.
    Schedule(std::uint32_t robots, double rate);

    /// Place in the sequence of all robots' scans, from 0 on, of scan `seq` (from 1 on) of a robot.
    [[nodiscard]] std::uint64_t place_of(std::uint32_t robot, std::uint64_t seq) const noexcept {
        return (seq - 1) * robots_ + robot;
    }
    [[nodiscard]] std::uint32_t robot_at(std::uint64_t place) const noexcept {
        return static_cast<std::uint32_t>(place % robots_);
    }
    [[nodiscard]] std::uint64_t seq_at(std::uint64_t place) const noexcept { return place / robots_ + 1; }

    /// Since the start, rounded down.
    [[nodiscard]] Micros due(std::uint64_t place) const noexcept {
        return static_cast<Micros>(static_cast<double>(place) * step_);
    }
    [[nodiscard]] Micros due(std::uint32_t robot, std::uint64_t seq) const noexcept {
        return due(place_of(robot, seq));
    }

    /// How many scans each robot sends that are due before `duration` of its own time is over: at least 1.
    [[nodiscard]] static std::uint64_t scans_within(double duration_s, double rate) noexcept;

private:
    std::uint64_t robots_ = 1;
    double step_ = 0.0; // microseconds from one scan of the sequence to the next
};

} // namespace scanloom::load
