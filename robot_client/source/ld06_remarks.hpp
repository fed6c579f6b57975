#pragma once

#include "robot_client/source/ld06_decoder.hpp"
#include "robot_client/source/ld06_turns.hpp"

#include <cstdint>
#include <string>

namespace scanloom::robot {

/// What happened to the turns that did not become scans.
struct Ld06Losses {
    std::uint64_t without_pose = 0;
    std::uint64_t too_many_waiting = 0; ///< nobody asked for them in time
};

/// What people should know of a sensor: "3 damaged packets, 225 turns, 4 of them cut by 2 gaps", and what else there is
/// to know.
[[nodiscard]] std::string ld06_remarks(const Ld06Counts& counts, const Ld06Turns& turns, const Ld06Losses& losses);

} // namespace scanloom::robot
