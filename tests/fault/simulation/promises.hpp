#pragma once

#include "tests/fault/fleet.hpp"
#include "tests/fault/outcome.hpp"
#include "tests/fault/simulation/disk.hpp"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace scanloom::simulation {

/// The scans that servers acknowledged as durable, whether the acknowledgement reached the robot or not.
///
/// Not part of the robots, because a robot whose program ends sends its recording again from the start and so fills a
/// gap that a server left. A check at the end alone would not find the gap.
class Promises {
public:
    /// Records an acknowledgement to this robot of all its scans up to `seq`. Robots of a story have distinct names.
    void say(const std::string& robot, std::uint64_t seq);

    /// Checks that all acknowledged scans are on the disk once, bit for bit. Pre: no server runs.
    [[nodiscard]] fault::Outcome check(store::MemoryScanLog& durable,
                                       const std::vector<fault::RobotPlan>& robots) const;

    /// Counts the acknowledged scans among those that the disk dropped after it had reported them as durable.
    [[nodiscard]] std::uint64_t count_broken(store::MemoryScanLog& durable,
                                             const std::vector<Disk::Dropped>& dropped) const;

private:
    [[nodiscard]] std::uint64_t promised(const std::string& robot) const;

    std::map<std::string, std::uint64_t> said_; // the highest seq, by robot
};

} // namespace scanloom::simulation
