#pragma once

#include "tests/fault/fleet.hpp"
#include "tests/fault/outcome.hpp"
#include "tests/fault/simulation/disk.hpp"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace scanloom::simulation {

/// What servers said is durable, whether it has reached the robot yet or not.
///
/// Kept apart from the robots: one whose program ends begins its recording again, and so fills the gap that a server
/// left. Who looks at the end only then finds nothing missing.
class Promises {
public:
    /// To this robot, of all its scans up to this one. Robots of a story have names of their own.
    void say(const std::string& robot, std::uint64_t seq);

    /// Whether all of it is on the disk, bit for bit, once. Looked at when no server runs.
    [[nodiscard]] fault::Outcome check(store::MemoryScanLog& durable,
                                       const std::vector<fault::RobotPlan>& robots) const;

    /// How many scans were promised of those that the disk dropped after it had called them durable.
    [[nodiscard]] std::uint64_t count_broken(store::MemoryScanLog& durable,
                                             const std::vector<Disk::Dropped>& dropped) const;

private:
    [[nodiscard]] std::uint64_t promised(const std::string& robot) const;

    std::map<std::string, std::uint64_t> said_; // the highest seq, by robot
};

} // namespace scanloom::simulation
