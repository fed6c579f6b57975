#pragma once

#include "robot_client/sources/ld06_packet.hpp"
#include "robot_client/sources/ld06_turns.hpp"

#include <cstdint>
#include <string>

namespace scanloom::robot {

/// Counts of the turns that did not become scans.
struct Ld06Losses {
    std::uint64_t without_pose = 0;
    std::uint64_t too_many_waiting = 0; ///< dropped because next() was not called in time
};

/// Returns a summary for people: "3 damaged packets, 225 turns, 4 of them cut by 2 gaps", and further losses.
[[nodiscard]] std::string ld06_remarks(const Ld06Counts& counts, const Ld06Turns& turns, const Ld06Losses& losses);

} // namespace scanloom::robot
