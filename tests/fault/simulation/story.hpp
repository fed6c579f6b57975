#pragma once

#include "tests/fault/outcome.hpp"
#include "tests/fault/simulation/world.hpp"

#include <cstdint>

namespace scanloom::simulation {

struct Story {
    std::uint64_t seed = 1;
    bool hasty_disk = false;     ///< a lie of the disk's, which must be found out
    bool forgetful_disk = false; ///< another
    World::Listener listener{};  ///< hears what happens
};

struct Ending {
    fault::Outcome outcome;
    std::uint64_t fingerprint = 0; ///< of all that happened
    std::uint64_t broken = 0;      ///< scans of which a robot was told that they are durable, and the disk dropped them
};

/// Robots stream to a server while both are killed and started again, the network and the disk do what they do at their
/// worst; then the world is calm, and all has to be there. What was acknowledged has to be on the disk whenever a
/// server has ended, too. The same seed is the same story to the nanosecond.
[[nodiscard]] Ending tell(const Story& story);

} // namespace scanloom::simulation
